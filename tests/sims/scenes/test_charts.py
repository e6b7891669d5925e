"""Charts: there and back, heights with the right sign, normals that are gradients of height."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from sims.scenes import CylinderChart, FoldChart, HeightChart, HeightMap, PlaneChart

SIZE = 24


def _numbers(*values):
    return jnp.asarray(values, dtype=float)


def _chart(kind, yaw=0.3):
    place = {"lower": _numbers(-1.0, 0.2), "upper": _numbers(1.0, 2.0)}
    if kind == "plane":
        return PlaneChart(origin=_numbers(0.1, -0.2, 0.3), yaw=jnp.asarray(yaw), **place)
    if kind == "fold":
        return FoldChart(
            origin=_numbers(0.8, 0.1, 0.0),
            yaw=jnp.asarray(yaw),
            interior=jnp.asarray(np.deg2rad(80)),
            **place,
        )
    if kind == "cylinder":
        return CylinderChart(
            axis=_numbers(1.5, 0.2, 0.1), yaw=jnp.asarray(yaw), radius=jnp.asarray(1.5), **place
        )
    u, v = np.meshgrid(np.arange(SIZE), np.arange(SIZE))
    depth = 0.02 * np.sin(0.3 * u) * np.cos(0.25 * v)
    valid = np.ones((SIZE, SIZE), dtype=bool)
    valid[10:13, 5:8] = False
    return HeightChart.of(
        HeightMap(
            jnp.asarray(depth), jnp.asarray(valid), _numbers(-1.0)[0], _numbers(0.2)[0], _numbers(0.08)[0]
        )
    )


KINDS = ["plane", "fold", "cylinder", "height"]
# The foot on a height map is found in two steps; its error grows with the third power of height by curvature.
TOLERANCE = {"plane": 1e-12, "fold": 1e-12, "cylinder": 1e-12, "height": 2e-4}


def _samples(chart, count=60):
    generator = np.random.default_rng(5)
    inner = np.asarray(chart.lower) + 0.1, np.asarray(chart.upper) - 0.1
    return jnp.asarray(generator.uniform(*inner, (count, 2))), jnp.asarray(
        generator.uniform(-0.03, 0.05, count)
    )


@pytest.mark.parametrize("kind", KINDS)
def test_there_and_back(x64, strict_ranks, kind):
    chart = _chart(kind)
    uv, height = _samples(chart)
    if kind == "fold":  # near the edge the other face may be closer
        uv = uv.at[:, 0].add(jnp.where(uv[:, 0] < 0, -0.1, 0.1))

    def round_trip(at, up):
        surface = chart.point(at)
        return chart.to_uv(surface + up * chart.normal(at)), chart.to_uv(surface)

    (back, found), (on_wall, zero) = jax.jit(jax.vmap(round_trip))(uv, height)
    np.testing.assert_allclose(back, uv, atol=TOLERANCE[kind])
    np.testing.assert_allclose(found, height, atol=TOLERANCE[kind])
    np.testing.assert_allclose(on_wall, uv, atol=1e-12)
    np.testing.assert_allclose(zero, 0.0, atol=1e-12)


@pytest.mark.parametrize("kind", KINDS)
def test_normals_are_gradients_of_height(x64, strict_ranks, kind):
    chart = _chart(kind)
    uv, _ = _samples(chart)

    def both(at):
        return chart.normal(at), jax.grad(lambda p: chart.to_uv(p)[1])(chart.point(at))

    normals, gradients = jax.jit(jax.vmap(both))(uv)
    np.testing.assert_allclose(gradients, normals, atol=1e-10)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, atol=1e-12)


@pytest.mark.parametrize("kind", KINDS)
def test_u_is_arc_length_to_the_right_and_v_up(x64, strict_ranks, kind):
    chart = _chart(kind, yaw=0.0)
    uv, _ = _samples(chart)
    right, up = jnp.moveaxis(jax.jit(jax.vmap(jax.jacfwd(chart.point)))(uv), 2, 0)
    assert np.all(right[:, 1] < 0) and np.all(up[:, 2] > 0)
    cross = np.cross(right, up)
    inwards = -np.asarray(jax.jit(jax.vmap(chart.normal))(uv))
    lengths = 1.0 if kind != "height" else np.linalg.norm(cross, axis=1)[:, None]
    # (u, v, into the wall) is left-handed as a robot sees it: right x up points back at the robot.
    np.testing.assert_allclose(cross / lengths, -inwards, atol=1e-10)
    if kind != "height":
        np.testing.assert_allclose(np.linalg.norm(right, axis=1), 1.0, atol=1e-12)


@pytest.mark.parametrize("kind", KINDS)
def test_height_is_above_zero_on_the_robots_side(x64, strict_ranks, kind):
    chart = _chart(kind, yaw=0.0)
    _, height = chart.to_uv(_numbers(-0.6, 0.0, 1.0))
    assert height > 0
    _, behind = chart.to_uv(chart.point(_numbers(0.3, 1.0)) + _numbers(0.05, 0.0, 0.0))
    assert behind < 0


def test_the_closest_face_of_a_fold_wins(x64):
    chart = _chart("fold")
    generator = np.random.default_rng(2)
    spots = jnp.asarray(generator.uniform(-0.6, 0.6, (200, 2)))
    turned = jax.jit(jax.vmap(chart.point))(jnp.column_stack([spots[:, 0], jnp.ones(200)]))
    points = turned + jnp.abs(spots[:, 1:]) * jax.jit(jax.vmap(chart.normal))(spots)
    _, height = jax.jit(jax.vmap(chart.to_uv))(points)
    dense = np.stack([np.linspace(-2, 2, 8001), np.ones(8001)], axis=1)
    surface = np.asarray(jax.jit(jax.vmap(chart.point))(jnp.asarray(dense)))
    nearest = np.linalg.norm(np.asarray(points)[:, None] - surface, axis=-1).min(axis=1)
    np.testing.assert_allclose(np.abs(height), nearest, atol=1e-3)


@pytest.mark.parametrize("kind", KINDS)
def test_extent(kind):
    chart = _chart(kind)
    middle = 0.5 * (chart.lower + chart.upper)
    assert bool(chart.on_surface(middle + 0.2))
    assert not bool(chart.on_surface(chart.upper + 0.01)) and not bool(chart.on_surface(chart.lower - 0.01))


def test_a_captured_hole_is_no_surface():
    chart = _chart("height")
    hole = _numbers(-1.0 + 6 * 0.08, 0.2 + 11 * 0.08)
    assert not bool(chart.on_surface(hole)) and bool(chart.on_surface(hole + 0.3))


def test_the_axis_of_a_column_has_finite_gradients(x64):
    chart = _chart("cylinder")
    jacobian = jax.jit(jax.jacrev(lambda p: jnp.append(*chart.to_uv(p))))(chart.axis)
    assert np.all(np.isfinite(jacobian))
