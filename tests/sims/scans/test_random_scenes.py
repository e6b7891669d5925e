"""Random scenes show what was wanted, within their ranges, and no more."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np

from sims.scans import KINDS, ScanSettings, random_scene
from sims.sensors import Camera

ABSENT = 500.0


@jax.jit
def _seen(samples):
    """Which body each pixel's ray meets in range, -1 for none."""

    def one(scene, center, rays, camera):
        def met(ray):
            distances = jnp.stack([body.intersect(center, ray).distance for body in scene.primitives])
            return jnp.where(distances.min() < camera.far, jnp.argmin(distances), -1)

        return jax.vmap(met)(rays)

    return jax.vmap(one)(samples.scene, samples.scan.center, samples.scan.rays, samples.camera)


@jax.jit
def _looked_at(samples):
    """The point that the camera looks at, in its own frame."""
    return jax.vmap(lambda T, chart: T.inverse().apply(chart.origin))(
        samples.T_map_camera, samples.scene.chart
    )


def _places(samples):
    """Where all bodies are, [samples, bodies, 3]."""
    bodies = samples.scene.primitives
    return np.stack([np.asarray(b.center if hasattr(b, "center") else b.foot) for b in bodies], axis=1)


def test_kinds_come_in_their_shares(batch):
    counts = np.bincount(np.asarray(batch.samples.kind), minlength=3) / len(batch.samples.kind)
    np.testing.assert_allclose(counts, 1 / 3, atol=0.08)


def test_distance_is_even_over_its_range(batch):
    depth = np.asarray(_looked_at(batch.samples))[:, 2]
    assert depth.min() >= 0.4 - 1e-5 and depth.max() <= 2.5 + 1e-5
    np.testing.assert_allclose(np.quantile(depth, [0.25, 0.5, 0.75]), [0.925, 1.45, 1.975], atol=0.2)


def test_what_is_looked_at_is_in_the_picture(batch):
    for kind, within in zip(KINDS, (0.0, 0.6, 0.0), strict=True):
        samples = batch.of(kind)
        x, y, z = np.asarray(_looked_at(samples)).T
        camera = samples.camera
        right = (x / z * camera.fx + camera.cx - 11.5) / 12
        down = (y / z * camera.fy + camera.cy - 7.5) / 8
        assert np.abs([right, down]).max() <= within + 1e-4


def test_flat_walls_are_slanted_up_to_the_limit(batch):
    samples = batch.of("objects")
    towards = np.asarray(samples.scan.center - samples.scene.chart.origin)
    cosine = (towards * np.asarray(samples.scene.primitives[0].R_map_plate)[:, :, 2]).sum(1)
    angle = np.arccos(cosine / np.linalg.norm(towards, axis=1))
    assert angle.max() <= 0.96 + 1e-3 and angle.max() > 0.85 and angle.min() < 0.2


def test_each_kind_has_its_bodies_and_no_others(batch):
    for kind in KINDS:
        there = np.abs(_places(batch.of(kind))).max(2) < ABSENT
        flat, second, bent, *things = there.T
        assert np.all(flat ^ bent)
        assert np.all(second == (kind == "corner"))
        assert (0.1 < bent.mean() < 0.4) if kind == "flat" else not bent.any()
        assert np.all(np.any(things, axis=0) == (kind == "objects"))
        assert kind != "objects" or np.all((np.mean(things, axis=1) > 0.6) & (np.mean(things, axis=1) < 0.95))


def test_pictures_show_what_their_kind_is_about(batch):
    share = {}
    for kind in KINDS:
        body = np.asarray(_seen(batch.of(kind)))
        share[kind] = np.stack([(body == number).mean(1) for number in range(7)], axis=1)
        filled = share[kind].sum(1)
        assert np.median(filled) > 0.9 and np.quantile(filled, 0.02) > 0.45
    assert np.quantile(share["corner"][:, :2].min(1), 0.02) > 0.03, "both faces of a corner are seen"
    things = share["objects"][:, 3:].sum(1)
    assert np.quantile(things, 0.05) > 0.01 and 0.05 < np.median(things) < 0.4
    assert np.quantile(share["objects"][:, 0], 0.05) > 0.1, "and the wall behind them"


def test_cameras_are_outside_of_all_objects(batch):
    near = np.asarray(jnp.where(batch.samples.scan.valid[..., None], batch.samples.scan.points, jnp.inf))
    gap = np.linalg.norm(near - np.asarray(batch.samples.scan.center)[:, None], axis=2).min(1)
    assert np.all(np.isinf(gap) | (gap > 0.19))


def test_corners_are_inside_and_outside_with_angles_in_range(batch):
    scene = batch.of("corner").scene
    normals = [np.asarray(face.R_map_plate)[:, :, 2] for face in scene.primitives[:2]]
    middles = [np.asarray(face.center) for face in scene.primitives[:2]]
    # Faces of an inside corner look at one another.
    inside = ((middles[1] - middles[0]) * normals[0]).sum(1) > 0
    assert 0.55 < inside.mean() < 0.85
    interior = np.pi - np.arccos(np.clip((normals[0] * normals[1]).sum(1), -1, 1))
    assert interior.min() > np.radians(59.9) and interior.max() < np.radians(150.1)
    for face, normal in zip(scene.primitives[:2], normals, strict=True):
        edge = np.asarray(scene.chart.origin) - np.asarray(face.center)
        np.testing.assert_allclose((edge * normal).sum(1), 0, atol=1e-5)
        np.testing.assert_allclose(np.linalg.det(np.asarray(face.R_map_plate)), 1, atol=1e-5)


def test_objects_stand_off_the_wall(batch):
    scene = batch.of("objects").scene
    wall, sphere = scene.primitives[0], scene.primitives[5]
    there = np.abs(np.asarray(sphere.center)).max(1) < ABSENT
    height = ((sphere.center - wall.center) * wall.R_map_plate[:, :, 2]).sum(1) - sphere.radius
    gap = np.asarray(height)[there]
    assert gap.min() > -1e-5 and gap.max() <= 0.25 + 1e-5 and np.median(gap) < 0.1


def test_colours_are_dark_and_bright_and_change_within_a_face(batch):
    samples = batch.of("flat")
    colours = np.asarray(samples.scan.colours)
    valid = np.asarray(samples.scan.valid)
    spread = np.array([np.ptp(c[v], axis=0).max() for c, v in zip(colours, valid, strict=True) if v.any()])
    assert 0.3 < (spread > 0.05).mean() < 0.95
    brightness = np.asarray(samples.scene.primitives[0].texture.first).mean(1)
    assert brightness.min() < 0.12 and brightness.max() > 0.8


def test_scored_sets_have_no_bent_walls(batch):
    settings = replace(batch.settings, shares=jnp.asarray([1.0, 0, 0])).scored()
    samples = batch.more("test", settings=settings)
    assert np.all(np.asarray(samples.kind) == 0)
    assert np.all(np.abs(np.asarray(samples.scene.primitives[2].foot)).max(1) > ABSENT)


def test_the_tree_is_the_same_for_all_kinds():
    key = jax.random.key(0)
    shapes = [
        jax.eval_shape(lambda kind=kind: random_scene(jnp.int32(kind), Camera(), ScanSettings(), key=key))
        for kind in range(3)
    ]
    assert shapes[0] == shapes[1] == shapes[2]
