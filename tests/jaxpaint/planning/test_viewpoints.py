"""Views cover the canvas with overlap; stations keep their distance."""

import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jaxpaint.planning import StationSettings, ViewpointSettings, plan_stations, plan_viewpoints

FIELD = (1.898, 1.109)


@given(width=st.floats(0.1, 5.0), height=st.floats(0.1, 2.5))
def test_views_cover_the_canvas(width, height):
    settings = ViewpointSettings()
    plan = plan_viewpoints((width, height), FIELD, settings)
    half = 0.5 * settings.distance * np.array(FIELD)
    u, v = np.meshgrid(np.linspace(-width / 2, width / 2, 40), np.linspace(-height / 2, height / 2, 20))
    points = np.stack([u, v], -1).reshape(-1, 1, 2)
    assert (np.abs(points - plan.view) <= half + 1e-9).all(-1).any(1).all()


def test_few_views():
    assert len(plan_viewpoints((0.6, 0.6), FIELD).view) == 1
    wide = plan_viewpoints((2.4, 0.6), FIELD)
    assert len(wide.view) == 2
    assert wide.stop[0] > wide.stop[-1]  # ends on the left, where drawings begin


def stations(weight=0.0):
    time = jnp.arange(40) * 0.5
    position = jnp.stack([jnp.zeros(40), jnp.linspace(1, -1, 40), jnp.ones(40)], axis=1)
    axis = jnp.tile(jnp.asarray([1.0, 0.0, 0.0]), (40, 1))
    surface = jnp.stack([jnp.zeros(50), jnp.linspace(-2, 2, 50), jnp.ones(50)], axis=1)
    settings = StationSettings(jnp.asarray(4.0), jnp.asarray(0.5))
    return position, plan_stations(
        time, position, axis, jnp.ones(40), surface, jnp.full(50, weight), jnp.asarray([0.85, 0.0]), settings
    )


def test_stations_lead_the_brush():
    position, places = stations()
    np.testing.assert_allclose(places[:, 0], -0.85, atol=1e-5)
    np.testing.assert_allclose(places[:, 2], 0, atol=1e-6)
    assert (places[:-1, 1] < position[:-1, 1]).all()  # the path goes to smaller y


def test_stations_keep_clear():
    close = jnp.asarray([[-0.7, 0.0, 1.0]])
    time = jnp.arange(10) * 0.5
    position = jnp.tile(jnp.asarray([0.0, 0.0, 1.0]), (10, 1))
    axis = jnp.tile(jnp.asarray([1.0, 0.0, 0.0]), (10, 1))
    settings = StationSettings(jnp.asarray(4.0), jnp.asarray(0.5))
    places = plan_stations(
        time, position, axis, jnp.ones(10), close, jnp.ones(1), jnp.asarray([0.85, 0.0]), settings
    )
    away = np.linalg.norm(np.asarray(places[:, :2]) - np.asarray(close[0, :2]), axis=1)
    assert away == pytest.approx(np.full(10, 0.5), abs=1e-4)
