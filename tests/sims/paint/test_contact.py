"""Brush poses become contacts."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from sims.paint import contact, wall_axes

CONTACT = jax.jit(contact)
INTO = jnp.asarray([1.0, 0, 0])
STILL = jnp.zeros(3)


def on(chart, position, axis=INTO, velocity=STILL):
    return CONTACT(chart, jnp.asarray(position), axis, velocity, jnp.asarray(0.1), jnp.asarray(1.0))


def test_foot_and_height(plane):
    found = on(plane().chart, [-0.004, 0.3, 1.2])
    np.testing.assert_allclose(found.uv, [-0.3, 1.2])
    assert found.height == pytest.approx(0.004)
    assert on(plane().chart, [0.002, 0.3, 1.2]).height == pytest.approx(-0.002)


def test_lean_points_where_the_bristles_point(plane):
    to_the_right_and_up = jnp.asarray([1.0, -0.1, 0.2]) / np.sqrt(1.05)
    np.testing.assert_allclose(
        on(plane().chart, [0.0, 0, 1], to_the_right_and_up).lean, [0.1, 0.2], rtol=1e-5
    )


def test_speed_is_along_the_wall(plane):
    assert on(plane().chart, [0.0, 0, 1], velocity=jnp.asarray([9.0, 0.03, 0.04])).speed == pytest.approx(
        0.05
    )


@pytest.mark.parametrize("axis", [[-1.0, 0, 0], [0.0, 1, 0]])
def test_a_brush_that_lies_or_looks_away_is_off_the_wall(plane, axis):
    assert on(plane().chart, [0.0, 0, 1], jnp.asarray(axis)).height == 1


def test_gradient_of_a_standing_brush_is_finite(plane):
    gradient = jax.grad(lambda v: on(plane().chart, [0.0, 0, 1], velocity=v).speed)(STILL)
    np.testing.assert_array_equal(gradient, 0)


def test_wall_axes_follow_the_chart(pillar):
    uv = jnp.asarray([0.3, 0.7])
    across, up, normal = wall_axes(pillar.chart.normal(uv))
    tangents = np.asarray(jax.jacfwd(pillar.chart.point)(uv))
    np.testing.assert_allclose(across, tangents[:, 0], atol=1e-6)
    np.testing.assert_allclose(up, tangents[:, 1], atol=1e-6)
    np.testing.assert_allclose(np.cross(across, up), normal, atol=1e-6)


def test_wall_axes_of_a_level_surface_are_a_frame():
    axes = np.asarray(wall_axes(jnp.asarray([0.0, 0, 1])))
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-6)
