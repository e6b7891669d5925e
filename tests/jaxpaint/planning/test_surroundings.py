"""What the lidar saw keeps the base and the arm away."""

import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.planning import surroundings
from jaxpaint.planning.surroundings import CLUTTER, backed, drives_clear, seen_over, stands_clear

FOOTPRINT = np.array([[0.4, 0.3], [-0.4, 0.3], [-0.4, -0.3], [0.4, -0.3]])
WALL = np.stack([np.zeros(201), np.linspace(-2, 2, 201)], axis=1)
CENTER = np.array([-0.05, 0.0, 1.1])


def test_walls_and_clutter_are_told_apart():
    found = surroundings(
        np.array([[0.0, 0.2], [-0.5, 0.1], [-0.5, 1.9], [np.nan, 0.0]]), CENTER, 0.0, 2.0, 0.4
    )
    np.testing.assert_array_equal(found.clutter, [[-0.5, 0.1]])
    assert len(found.walls) == 2  # the wall itself, and what stands well beside the canvas
    assert len(found.echoes) == 3


def test_clutter_counts_up_to_its_height_and_walls_at_all_heights():
    found = surroundings(np.array([[0.0, 0.0], [-0.5, 0.0]]), CENTER, 0.0, 2.0, 0.4)
    gap = found.gap(np.array([[-0.5, 0.1, 0.3], [-0.5, 0.1, 0.4 + CLUTTER + 0.01]]))
    np.testing.assert_allclose(gap, [0.1, np.hypot(0.5, 0.1)])


def test_what_was_seen_behind_an_echo_tells_where_it_ends():
    """A crate before a wall that the camera saw from 0.7 m up; beside it nothing is behind."""
    y, z = (x.ravel() for x in np.meshgrid(np.linspace(-1, 1, 41), np.linspace(0.7, 1.4, 15)))
    scanned = jnp.asarray(np.stack([0 * y, y, z], axis=1)).at[0].set(jnp.nan)
    echoes = jnp.asarray([[-0.23, 0.0], [0.01, 0.5], [np.nan, 0.0]])
    over = seen_over(echoes, scanned, jnp.array([1.0, 0.0]))
    np.testing.assert_allclose(over, [0.7, np.inf, np.inf])


def test_a_slanted_wall_does_not_end_where_it_was_seen():
    along, z = (x.ravel() for x in np.meshgrid(np.linspace(-1, 1, 81), np.linspace(0.7, 1.4, 15)))
    slanted = np.array([np.sin(np.pi / 3), np.cos(np.pi / 3)])
    scanned = np.concatenate([along[:, None] * slanted, z[:, None]], axis=1)
    over = seen_over(jnp.asarray(along[:81, None] * slanted), jnp.asarray(scanned), jnp.array([1.0, 0.0]))
    assert np.isinf(over).all()


def test_nothing_seen_is_nothing_near():
    found = surroundings(np.full((3, 2), np.nan), CENTER, 0.0, 2.0, 0.4)
    assert np.isinf(found.gap(np.zeros((2, 3)))).all()
    assert stands_clear(np.zeros(3), FOOTPRINT, found.echoes, 0.1)


@pytest.mark.parametrize(
    ("x", "yaw", "clear"),
    [(-0.6, 0.0, True), (-0.45, 0.0, False), (-0.45, np.pi / 2, True), (-0.38, np.pi / 2, False)],
)
def test_the_footprint_turns_with_the_base(x, yaw, clear):
    assert stands_clear(np.array([x, 0.0, yaw]), FOOTPRINT, WALL, 0.1) == clear


def test_a_wall_beside_the_base_counts_too():
    side = np.stack([np.linspace(-2, 0, 101), np.full(101, 0.35)], axis=1)
    assert not stands_clear(np.array([-1.0, 0.0, 0.0]), FOOTPRINT, side, 0.1)
    assert stands_clear(np.array([-1.0, -0.1, 0.0]), FOOTPRINT, side, 0.1)


def test_a_base_moves_back_just_far_enough():
    stop = backed(np.array([-0.2, 0.0, 0.0]), FOOTPRINT, WALL, 0.1)
    assert stop[0] == pytest.approx(-0.5, abs=1e-5)
    assert stands_clear(stop, FOOTPRINT, WALL, 0.1)


def test_a_box_on_the_way_blocks_it():
    start, end = np.array([-1.0, -1.0, 0.0]), np.array([-1.0, 1.0, 0.0])
    assert drives_clear(start, end, FOOTPRINT, WALL, 0.1)
    assert not drives_clear(start, end, FOOTPRINT, np.array([[-1.2, 0.0]]), 0.1)
    assert drives_clear(start, end, FOOTPRINT, np.array([[-1.55, 0.0]]), 0.1)


def test_turning_on_the_spot_needs_room_for_the_corners():
    close = np.array([[0.0, 0.45]])
    start, end = np.zeros(3), np.array([0.0, 0.0, np.pi])
    assert stands_clear(start, FOOTPRINT, close, 0.05)
    assert not drives_clear(start, end, FOOTPRINT, close, 0.05)
