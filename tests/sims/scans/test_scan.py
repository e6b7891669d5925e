"""Clouds of pictures, and windows of them."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.kinematics.pose import Pose
from sims.scans import closest_point, random_window, take_scan
from sims.scans.window import ray_at
from sims.scenes import objects
from sims.sensors import Camera, DepthNoise, pixel_rays

CAMERA = Camera(width=24, height=16, cx=11.5, cy=7.5, fx=20.0, fy=20.0)


@pytest.fixture
def T_map_camera(R_map_camera):
    return Pose(jnp.asarray([-1.5, 0.1, 1.2]), R_map_camera)


@pytest.fixture(scope="module")
def scan_of():
    return jax.jit(lambda pose, noise, key: take_scan(objects(), pose, CAMERA, noise, key=key))


def test_without_noise_all_points_lie_on_the_surface(scan_of, T_map_camera):
    scan = scan_of(T_map_camera, DepthNoise.zero(), jax.random.key(0))
    _, distance = jax.jit(jax.vmap(closest_point, in_axes=(None, 0)))(objects(), scan.points)
    valid = np.asarray(scan.valid)
    assert valid.all()
    assert np.asarray(distance).max() < 1e-5


def test_points_lie_on_their_rays(scan_of, T_map_camera):
    scan = scan_of(T_map_camera, DepthNoise(), jax.random.key(0))
    offset = np.asarray(scan.points - scan.center)
    np.testing.assert_allclose(np.linalg.norm(scan.rays, axis=1), 1, atol=1e-6)
    np.testing.assert_allclose(np.cross(offset, scan.rays), 0, atol=1e-5)
    assert np.all((offset * np.asarray(scan.rays)).sum(1)[scan.valid] > 0)
    assert np.all(offset[~np.asarray(scan.valid)] == 0)
    # The middle of the picture looks along +x of the map.
    np.testing.assert_allclose(scan.rays.mean(0) / np.linalg.norm(scan.rays.mean(0)), [1, 0, 0], atol=1e-4)


def test_windows_are_parts_of_the_picture():
    whole = Camera()
    window = jax.jit(jax.vmap(lambda key: random_window(whole, 128, 60, key=key)))(
        jax.random.split(jax.random.key(1), 500)
    )
    columns, rows = np.asarray(whole.cx - window.cx), np.asarray(whole.cy - window.cy)
    for first, spare in ((columns, 84), (rows, 60)):
        assert first.min() == 0 and first.max() == spare and np.all(first == np.round(first))
    one = random_window(whole, 128, 60, key=jax.random.key(3))
    column, row = int(whole.cx - one.cx), int(whole.cy - one.cy)
    part = pixel_rays(whole)[row : row + 60, column : column + 128]
    np.testing.assert_allclose(pixel_rays(one), part, atol=1e-6)


def test_larger_windows_go_beyond_the_picture_on_both_sides():
    window = random_window(Camera(), 128, 128, key=jax.random.key(1))
    assert float(window.cy) == 63.5 and (window.width, window.height) == (128, 128)


def test_the_middle_and_the_edges_of_a_picture():
    rays = np.asarray(pixel_rays(CAMERA))
    np.testing.assert_allclose(ray_at(CAMERA, jnp.zeros(2)), rays.mean((0, 1)), atol=1e-6)
    corner = np.asarray(ray_at(CAMERA, jnp.ones(2)))
    np.testing.assert_allclose(corner[:2] - rays[-1, -1, :2], 0.5 / 20, atol=1e-6)
