"""Views cover the canvas with overlap; stations keep their distance."""

import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jaxpaint.planning import StationSettings, ViewpointSettings, plan_stations, plan_viewpoints, wall_profile

FIELD = (1.898, 1.109)


HOME = (0.85, 0.0)
FOOTPRINT = np.array([[0.375, 0.3], [-0.375, 0.3], [-0.375, -0.3], [0.375, -0.3]])
NOTHING = np.full((1, 2), np.nan)


def straight(width):
    """The outline of a flat wall at x = 0."""
    return wall_profile(
        np.array([-0.05, 0.0, 1.1]), 0.0, width, np.stack([np.zeros(400), np.linspace(-4, 4, 400)], 1)
    )


def plan(profile, height=0.6, echoes=NOTHING):
    return plan_viewpoints(profile, (1.1 - height / 2, 1.1 + height / 2), FIELD, HOME, FOOTPRINT, echoes)


@given(width=st.floats(0.1, 5.0), height=st.floats(0.1, 2.0))
def test_views_cover_the_canvas(width, height):
    settings = ViewpointSettings()
    views = plan(straight(width), height)
    half = 0.5 * settings.distance * np.array(FIELD)
    y, z = np.meshgrid(
        np.linspace(-width / 2, width / 2, 40) * 0.95, np.linspace(-height / 2, height / 2, 20) + 1.1
    )
    points = np.stack([y, z], -1).reshape(-1, 1, 2)
    assert (np.abs(points - views.camera[:, 1:]) <= half + 1e-6).all(-1).any(1).all()
    np.testing.assert_allclose(views.camera[:, 0], -settings.distance, atol=1e-6)


def test_few_views_that_end_on_the_left():
    assert len(plan(straight(0.6)).camera) == 1
    wide = plan(straight(2.4))
    assert len(wide.camera) == 2
    assert wide.base[0, 1] < wide.base[-1, 1]  # the map's y points to the robot's left


def test_views_of_a_corner_face_its_faces():
    y = np.linspace(-1.5, 1.5, 600)
    echoes = np.stack([0.85 - np.abs(y), y], axis=1)
    profile = wall_profile(np.array([-0.05, 0.0, 1.1]), 0.0, 1.697, echoes)
    assert profile.length == pytest.approx(1.697 * np.sqrt(2), rel=0.06)
    views = plan(profile)
    np.testing.assert_allclose(np.sort(views.heading), [-np.pi / 4, np.pi / 4], atol=0.02)
    room = np.linalg.norm(views.base[:, None, :2] - echoes, axis=-1).min(axis=1)
    assert (room > 0.7).all()


def test_the_base_keeps_back_from_clutter():
    clutter = np.array([[-0.45, 0.1]])
    free, kept = plan(straight(0.6)), plan(straight(0.6), echoes=clutter)
    assert free.base[0, 0] == pytest.approx(-0.85, abs=1e-6)
    assert kept.base[0, 0] + 0.375 <= -0.45 - 0.079


def test_a_blind_lidar_means_a_wall_at_the_canvas():
    profile = wall_profile(np.array([-0.05, 0.0, 1.1]), 0.0, 1.0, NOTHING)
    np.testing.assert_allclose(profile.points[:, 0], 0.0, atol=1e-9)


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
