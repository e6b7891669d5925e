"""Nearest points against brute force, on the surface and at the places where gradients could break."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from sims.scans import closest_point
from sims.scans.closest import closest_on
from sims.scenes import Box, CylinderPatch, Floor, Plain, PlaneChart, Post, Rectangle, Scene, Sphere, objects


def _numbers(*values):
    return jnp.asarray(values, dtype=float)


def _tilt():
    normal = np.array([-0.8, 0.36, 0.48])
    right = np.cross([0, 0, 1.0], normal)
    right /= np.linalg.norm(right)
    return jnp.asarray(np.stack([right, np.cross(normal, right), normal], axis=1), dtype=float)


def _grey():
    return Plain(_numbers(0.5, 0.5, 0.5))


BODIES = {
    "rectangle": lambda: Rectangle(_numbers(0, 0, 1), _tilt(), _numbers(0.6, 0.4), _grey()),
    "box": lambda: Box(_numbers(0.3, 0, 1), _tilt(), _numbers(0.3, 0.2, 0.25), _grey()),
    "sphere": lambda: Sphere(_numbers(0.4, 0.1, 1.0), _numbers(0.4)[0], _grey()),
    "cylinder": lambda: CylinderPatch(_numbers(0.5, 0, 0.2), *_numbers(0.7, 0.5, 1.2, 1.1), _grey()),
    "post": lambda: Post(_numbers(0.3, 0, 0.4), *_numbers(0.35, 0.7), _grey()),
    "floor": lambda: Floor(_numbers(0.1)[0], _grey()),
}


def _grid(first, second, count=300):
    a, b = np.meshgrid(np.linspace(*first, count), np.linspace(*second, count), indexing="ij")
    return a.ravel(), b.ravel()


def _samples(kind, body):
    """A fine grid of points on the body's surface, written down afresh."""
    one = (-1.0, 1.0)
    if kind == "rectangle":
        u, v = _grid(one, one)
        local = np.stack([u * float(body.half[0]), v * float(body.half[1]), 0 * u], axis=1)
        return np.asarray(body.center) + local @ np.asarray(body.R_map_plate).T
    if kind == "box":
        u, v = _grid(one, one)
        faces = [np.stack(np.roll([s + 0 * u, u, v], k, 0), axis=1) for k in range(3) for s in one]
        return (
            np.asarray(body.center)
            + np.concatenate(faces) * np.asarray(body.half) @ np.asarray(body.R_map_box).T
        )
    if kind == "sphere":
        a, b = _grid((0, 2 * np.pi), (0, np.pi))
        unit = np.stack([np.cos(a) * np.sin(b), np.sin(a) * np.sin(b), np.cos(b)], axis=1)
        return np.asarray(body.center) + float(body.radius) * unit
    if kind == "cylinder":
        a, h = _grid((-float(body.half_angle), float(body.half_angle)), (0, float(body.height)))
        # Seen along yaw, the middle generator is the near one: straight back from the axis.
        a = a + float(body.yaw) + np.pi
        round_ = float(body.radius) * np.stack([np.cos(a), np.sin(a)], axis=1)
        return np.asarray(body.foot) + np.column_stack([round_, h])
    if kind == "post":
        a, share = _grid((0, 2 * np.pi), (0, 1))
        rim = float(body.radius) * np.stack([np.cos(a), np.sin(a)], axis=1)
        side = np.column_stack([rim, share * float(body.height)])
        ends = [np.column_stack([share[:, None] * rim, h + 0 * a]) for h in (0.0, float(body.height))]
        return np.asarray(body.foot) + np.concatenate([side, *ends])
    x, y = _grid((-1.5, 2.5), (-2.0, 2.0))
    return np.stack([x, y, float(body.height) + 0 * x], axis=1)


def _around(count=60):
    return np.random.default_rng(5).uniform([-0.6, -0.9, 0.0], [1.2, 0.9, 1.9], (count, 3))


@pytest.mark.parametrize("kind", BODIES)
def test_the_nearest_point_is_the_nearest_of_many(x64, strict_ranks, kind):
    body, points = BODIES[kind](), _around()
    nearest = np.asarray(jax.vmap(closest_on, in_axes=(None, 0))(body, jnp.asarray(points)))
    surface = _samples(kind, body)
    exact = np.linalg.norm(nearest - points, axis=1)
    brute = np.array([np.linalg.norm(surface - p, axis=1).min() for p in points])
    assert np.all(exact <= brute + 1e-12)
    np.testing.assert_allclose(exact, brute, atol=0.008)
    # And it is on the surface.
    assert max(np.linalg.norm(surface - p, axis=1).min() for p in nearest) < 0.015


@pytest.mark.parametrize("kind", BODIES)
def test_a_point_of_the_surface_is_its_own_nearest(x64, kind):
    body = BODIES[kind]()
    points = jnp.asarray(_samples(kind, body)[::997])
    np.testing.assert_allclose(jax.vmap(closest_on, in_axes=(None, 0))(body, points), points, atol=1e-12)


@pytest.mark.parametrize("kind", BODIES)
def test_gradients_of_distance_are_unit_vectors_to_the_point(x64, strict_ranks, kind):
    scene = _scene(BODIES[kind]())
    points = jnp.asarray(_around())
    slopes = jax.jit(jax.vmap(jax.grad(lambda p: closest_point(scene, p)[1])))(points)
    nearest, distance = jax.vmap(closest_point, in_axes=(None, 0))(scene, points)
    np.testing.assert_allclose(slopes, (points - nearest) / distance[:, None], atol=1e-9)


# Centres, axes, edges, corners, and points on the surface.
HARD = {
    "rectangle": [(0, 0, 1)],
    "box": [(0.3, 0, 1)],
    "sphere": [(0.4, 0.1, 1.0), (0.8, 0.1, 1.0)],
    "cylinder": [(0.5, 0, 1.0), (0.5, 0, 0.2), (0.5, 0, 3.0)],
    "post": [(0.3, 0, 0.75), (0.3, 0, 0.4), (0.3, 0, 2.0), (0.65, 0, 1.1), (0.65, 0, 0.5)],
    "floor": [(0, 0, 0.1)],
}


@pytest.mark.parametrize("kind", BODIES)
def test_gradients_are_finite_at_centres_and_edges(strict_ranks, kind):
    body = BODIES[kind]()
    points = jnp.asarray(HARD[kind], dtype=float)
    if kind in ("rectangle", "box"):
        R = body.R_map_plate if kind == "rectangle" else body.R_map_box
        half = jnp.append(body.half, 0.0)[:3]
        points = jnp.concatenate([points, (body.center + R @ half)[None], (body.center + R[:, 0])[None]])
    slopes = jax.jit(jax.vmap(jax.jacrev(lambda p: closest_point(_scene(body), p))))(points)
    assert all(np.all(np.isfinite(slope)) for slope in jax.tree.leaves(slopes))


def test_hits_of_a_scene_are_their_own_nearest_points():
    scene = objects()
    ahead = np.random.default_rng(2).normal([1.0, 0, -0.1], [0.1, 0.4, 0.3], (500, 3))
    along = jnp.asarray(ahead / np.linalg.norm(ahead, axis=1, keepdims=True), dtype=float)

    def gap(direction):
        origin = _numbers(-1.5, 0.0, 1.2)
        hit = scene.raycast(origin, direction)
        point = origin + jnp.where(hit.valid, hit.distance, 0.0) * direction
        nearest, distance = closest_point(scene, point)
        return hit.valid, distance, jnp.abs(nearest - point).max()

    met, distance, apart = jax.jit(jax.vmap(gap))(along)
    assert np.asarray(met).mean() > 0.9
    assert np.asarray(distance)[met].max() < 1e-5 and np.asarray(apart)[met].max() < 1e-5


def test_a_scene_has_the_nearest_of_its_bodies():
    scene = _scene(BODIES["sphere"](), BODIES["floor"]())
    nearest, distance = closest_point(scene, _numbers(0.4, 0.1, 1.5))
    np.testing.assert_allclose(nearest, [0.4, 0.1, 1.4], atol=1e-6)
    np.testing.assert_allclose(distance, 0.1, atol=1e-6)
    np.testing.assert_allclose(closest_point(scene, _numbers(0.4, 0.1, 0.2))[1], 0.1, atol=1e-6)


def test_a_body_without_a_rule_is_refused():
    class Blob(Sphere.__mro__[1]):  # another AbstractPrimitive
        texture: Plain

        def intersect(self, origin, direction):
            raise NotImplementedError

    with pytest.raises(TypeError, match=r"Blob; known: .*Rectangle.*Box"):
        closest_point(_scene(Blob(_grey())), _numbers(0, 0, 0))


def _scene(*bodies):
    chart = PlaneChart(_numbers(0, 0, 0), _numbers(0)[0], _numbers(-1, -1), _numbers(1, 1))
    return Scene(bodies, chart, "test")
