"""Stretches of a brush path that one base place serves."""

import jax
import jax.numpy as jnp
import numpy as np

from jaxpaint.planning.stretches import ReachWindow, serving_places

HOME = np.array([0.8, 0.1])
WINDOW = ReachWindow(jnp.asarray(0.4), jnp.asarray(0.3))


def _places(y, down, heading=None):
    """Serving places of a brush on the plane x = 0, or on walls of these headings through the origin."""
    yaw = np.zeros(len(y)) if heading is None else heading
    position = np.stack([np.zeros_like(y), y, np.ones_like(y)], axis=1)
    axis = np.stack([np.cos(yaw), np.sin(yaw), np.zeros_like(y)], axis=1)
    run = jax.jit(serving_places)
    return np.asarray(run(*(jnp.asarray(x) for x in (position, axis, down, HOME)), WINDOW))


def test_one_place_serves_all_that_fits_the_window():
    y = 0.19 * np.sin(np.linspace(0, 40, 200))
    places = _places(y, np.ones(200))
    middle = (y.min() + y.max()) / 2
    np.testing.assert_allclose(places, np.tile([-HOME[0], middle - HOME[1], 0], (200, 1)), atol=1e-6)


def test_a_long_line_takes_the_fewest_stretches_and_none_is_wider_than_the_window():
    y = np.linspace(0, 1.19, 600)
    places = _places(y, np.ones(600))[:, 1] + HOME[1]
    assert len(np.unique(places.round(5))) == 3
    assert np.abs(y - places).max() <= 0.2 + 1e-6


def test_what_the_pen_does_in_the_air_widens_no_stretch_and_belongs_to_the_next():
    y = np.concatenate([np.zeros(10), np.linspace(0, 5, 20), np.full(10, 1.0)])
    down = np.concatenate([np.ones(10), np.zeros(20), np.ones(10)])
    places = _places(y, down)[:, 1] + HOME[1]
    np.testing.assert_allclose(places[:10], 0, atol=1e-6)
    np.testing.assert_allclose(places[10:], 1.0, atol=1e-6)


def test_a_turned_wall_is_a_stretch_of_its_own():
    heading = np.repeat([0.0, np.pi / 2], 20)
    places = _places(np.zeros(40), np.ones(40), heading)
    np.testing.assert_allclose(places[0], [-HOME[0], -HOME[1], 0], atol=1e-6)
    np.testing.assert_allclose(places[-1], [HOME[1], -HOME[0], np.pi / 2], atol=1e-6)


def test_a_path_without_a_stroke_stays_finite():
    assert np.isfinite(_places(np.linspace(0, 1, 10), np.zeros(10))).all()
