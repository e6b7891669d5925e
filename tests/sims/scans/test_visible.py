"""Samples of the visible surface: even by area, on the surface, in the picture."""

import jax
import jax.numpy as jnp
import numpy as np
from shapely import Polygon, box

from jaxpaint.kinematics.pose import Pose
from sims.scans import closest_point, visible_surface
from sims.scans.visible import stratified
from sims.scans.window import ray_at
from sims.scenes import Plain, PlaneChart, Rectangle, Scene
from sims.sensors import Camera, render

CAMERA = Camera(width=24, height=16, cx=11.5, cy=7.5, fx=20.0, fy=20.0)
SLANT = 0.9


def _slanted():
    """A large plate at depth 1 m, and a camera in the map's origin along its z axis."""
    c, s = np.cos(SLANT), np.sin(SLANT)
    R = jnp.asarray([[c, 0, -s], [0, -1, 0], [-s, 0, -c]], dtype=float)
    plate = Rectangle(jnp.asarray([0, 0, 1.0]), R, jnp.asarray([9.0, 9.0]), Plain(jnp.full(3, 0.5)))
    chart = PlaneChart(jnp.zeros(3), jnp.zeros(()), -jnp.ones(2), jnp.ones(2))
    return Scene((plate,), chart, "slanted"), Pose(jnp.zeros(3), jnp.eye(3))


@jax.jit
def _sampled(blocked, key):
    scene, pose = _slanted()
    truth = render(scene, CAMERA, pose.p, pose.R)
    return visible_surface(scene, pose, CAMERA, truth, truth.valid & ~blocked, 4000, key=key)


def _footprint():
    """What the picture sees of the plate, in the plate's own coordinates."""
    scene, _ = _slanted()
    plate, corners = scene.primitives[0], []
    for place in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
        ray = np.asarray(ray_at(CAMERA, jnp.asarray(place, dtype=float)))
        normal = np.asarray(plate.R_map_plate)[:, 2]
        point = ray * (np.asarray(plate.center) @ normal) / (ray @ normal)
        corners.append((np.asarray(plate.R_map_plate).T @ (point - np.asarray(plate.center)))[:2])
    return Polygon(corners)


def test_samples_of_a_slanted_plane_are_even_by_area():
    found = _sampled(jnp.zeros((16, 24), bool), jax.random.key(2))
    plate = _slanted()[0].primitives[0]
    u, v, off = np.asarray(plate.R_map_plate).T @ np.asarray(found.points - plate.center).T
    footprint = _footprint()
    np.testing.assert_allclose(off, 0, atol=1e-5)
    assert found.valid.all()
    low, below, high, above = footprint.bounds
    for share in (0.15, 0.3, 0.5, 0.7):
        cut = low + share * (high - low)
        wanted = footprint.intersection(box(low, below, cut, above)).area / footprint.area
        np.testing.assert_allclose((u < cut).mean(), wanted, atol=0.015)
        cut = below + share * (above - below)
        wanted = footprint.intersection(box(low, below, high, cut)).area / footprint.area
        np.testing.assert_allclose((v < cut).mean(), wanted, atol=0.015)
    # Even by pixels it would be far from that.
    assert abs((found.points[:, 0] < 0).mean() - 0.5) > 0.2
    assert 0.9 < found.effective <= 1.0001


def test_only_pixels_that_are_valid_in_the_scan_count():
    blocked = jnp.zeros((16, 24), bool).at[:, :12].set(True)
    points = np.asarray(_sampled(blocked, jax.random.key(2)).points)
    assert np.all(points[:, 0] / points[:, 2] * 20 + 11.5 > 11.5 - 1e-3)


def test_a_scan_without_a_valid_pixel_has_no_samples():
    found = _sampled(jnp.ones((16, 24), bool), jax.random.key(2))
    assert not found.valid.any() and np.all(np.isfinite(found.points)) and found.effective == 0


def test_samples_lie_on_the_surface_and_in_the_picture(batch):
    samples = batch.samples
    nearest = jax.jit(jax.vmap(jax.vmap(closest_point, in_axes=(None, 0))))
    _, distance = nearest(samples.scene, samples.visible.points)
    assert np.asarray(jnp.where(samples.visible.valid, distance, 0)).max() < 1e-5
    assert np.asarray(samples.visible.valid)[np.asarray(samples.scan.valid).any(1)].all()
    inverse = jax.jit(jax.vmap(lambda T, points: T.inverse().apply(points)))
    x, y, z = np.moveaxis(np.asarray(inverse(samples.T_map_camera, samples.visible.points)), 2, 0)
    valid = np.asarray(samples.visible.valid)
    camera = jax.tree.map(lambda leaf: np.asarray(leaf)[:, None], samples.camera)
    column, row = (x / z * camera.fx + camera.cx)[valid], (y / z * camera.fy + camera.cy)[valid]
    assert column.min() > -0.501 and column.max() < 23.501 and row.min() > -0.501 and row.max() < 15.501
    assert z[valid].min() > 0.19 and z[valid].max() < 6.01


def test_weights_do_not_degenerate(batch):
    effective = np.asarray(batch.samples.visible.effective)
    assert np.quantile(effective, 0.02) > 0.4 and np.median(effective) > 0.9


def test_stratified_draws_follow_the_weights():
    weights = jnp.asarray([0.0, 1.0, 3.0, 0.0, 4.0, 0.0])
    index = np.asarray(stratified(weights, 8000, key=jax.random.key(0)))
    np.testing.assert_allclose(np.bincount(index, minlength=6), [0, 1000, 3000, 0, 4000, 0], atol=2)
    assert np.all(np.diff(index) >= 0)
