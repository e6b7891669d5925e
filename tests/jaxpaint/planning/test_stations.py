"""Stations lead the brush and keep their distance."""

import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.planning import ReachWindow, StationSettings, plan_stations


def settings_of(clearance, footprint=None):
    reach = ReachWindow(jnp.asarray(0.4), jnp.asarray(0.3))
    return StationSettings(reach, jnp.asarray(clearance), footprint)


def stations(weight=0.0):
    position = jnp.stack([jnp.zeros(40), jnp.linspace(1, -1, 40), jnp.ones(40)], axis=1)
    axis = jnp.tile(jnp.asarray([1.0, 0.0, 0.0]), (40, 1))
    surface = jnp.stack([jnp.zeros(50), jnp.linspace(-2, 2, 50), jnp.ones(50)], axis=1)
    settings = settings_of(0.5)
    return position, plan_stations(
        position, axis, jnp.ones(40), surface, jnp.full(50, weight), jnp.asarray([0.85, 0.0]), settings
    )


def test_stations_serve_stretches():
    position, places = stations()
    np.testing.assert_allclose(places[:, 0], -0.85, atol=1e-5)
    np.testing.assert_allclose(places[:, 2], 0, atol=1e-6)
    assert np.abs(places[:, 1] - position[:, 1]).max() <= 0.2 + 1e-5
    assert len(np.unique(np.round(places[:, 1], 4))) <= 6  # 2 m in windows of 0.4 m


def test_stations_keep_clear():
    close = jnp.asarray([[-0.7, 0.0, 1.0]])
    position = jnp.tile(jnp.asarray([0.0, 0.0, 1.0]), (10, 1))
    axis = jnp.tile(jnp.asarray([1.0, 0.0, 0.0]), (10, 1))
    settings = settings_of(0.5)
    places = plan_stations(
        position, axis, jnp.ones(10), close, jnp.ones(1), jnp.asarray([0.85, 0.0]), settings
    )
    away = np.linalg.norm(np.asarray(places[:, :2]) - np.asarray(close[0, :2]), axis=1)
    assert away == pytest.approx(np.full(10, 0.5), abs=1e-4)


def beside_a_side_wall(footprint):
    """Stations for a brush path on x = 0 that goes to a side wall on the robot's left, at y = 0.3."""
    position = jnp.stack([jnp.zeros(10), jnp.linspace(0.0, 0.2, 10), jnp.ones(10)], axis=1)
    axis = jnp.tile(jnp.asarray([1.0, 0.0, 0.0]), (10, 1))
    along = jnp.linspace(-2, 0, 81)
    surface = jnp.stack([along, jnp.full(81, 0.3), jnp.ones(81)], axis=1)
    settings = settings_of(0.1, footprint)
    home = jnp.asarray([0.85, 0.0])
    places = plan_stations(position, axis, jnp.ones(10), surface, jnp.ones(81), home, settings)
    return np.asarray(places), np.asarray(surface)[:, :2]


def test_the_whole_footprint_keeps_clear():
    footprint = np.array([[0.4, 0.3], [-0.4, 0.3], [-0.4, -0.3], [0.4, -0.3]])
    places, wall = beside_a_side_wall(jnp.asarray(footprint))
    low, high = footprint.min(0) - 0.1 + 1e-3, footprint.max(0) + 0.1 - 1e-3
    for x, y, yaw in places:
        c, s = np.cos(yaw), np.sin(yaw)
        local = (wall - [x, y]) @ np.array([[c, -s], [s, c]])
        assert not ((local > low) & (local < high)).all(-1).any()
    np.testing.assert_allclose(places[:, 0], -0.85, atol=1e-3)  # it moves aside, not back
    np.testing.assert_allclose(places[:, 1], -0.1, atol=5e-3)


def test_the_distance_from_the_middle_alone_lets_corners_touch():
    places, _ = beside_a_side_wall(None)
    assert places[-1, 1] + 0.3 > 0.3  # 0.1 m from the middle is kept, and no more
