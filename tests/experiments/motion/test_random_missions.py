"""Random missions: no limit exceeded, no jump, no touch, and nearly as fast as can be."""

import dataclasses

import jax
import numpy as np
import pytest

from experiments.motion import check, random_missions
from experiments.motion.missions import TARGETS
from jaxpaint.trajectories import slowed
from sims.painting.motion import SETTLE

# Acceleration builds up over a twenty-fifth of a second (0.04 s) at the quickest, from nothing to the limit.
_ACCELERATION = np.array([0.5, 1.0, 8.0])  # base's place, its yaw, the arm
# So few missions at most may be refused for want of a way that the planner knows to be clear.
_REFUSED = 0.15


def _hold(checked):
    for one in checked:
        assert max(one.speed, one.acceleration, one.torque) <= 1.001
        assert not one.collides
        # from one millisecond to the next a fortieth of the limit; what jumped in position or speed, at a via
        # point, a waypoint or an end, would show as far more
        assert (np.array(one.jump) < _ACCELERATION / 40 * 1.1).all()
        assert one.bound * 0.99 <= one.moving <= 1.15 * one.bound


@pytest.fixture(scope="module")
def few():
    return random_missions("corner", 6)


@pytest.mark.slow
def test_a_few_missions_before_a_corner(few):
    assert few.refused.sum() <= 1
    _hold(check(few))


@pytest.mark.slow
def test_they_touch_with_the_brush_and_rest_only_where_they_must(few):
    """The brush at the wall, at rest at each waypoint; at via points no longer than wheels need to turn."""
    trajectory = few.motion.trajectory
    start, segments = np.asarray(trajectory.start, float), np.asarray(trajectory.segments, float)
    rest = np.asarray(trajectory.rest, float)
    # no via point but where the way is bent, no move but where a waypoint differs from the one before, and
    # that is at all targets: none is repeated
    moves = np.abs(np.diff(few.waypoints, axis=1)).max(-1) > 0
    np.testing.assert_array_equal(segments[:, 2::3] > 0, moves)
    assert (moves.sum(1) == TARGETS + 1 + 2 * few.touches.sum(1)).all()
    gaps = start[:, 1:] - start[:, :-1] - segments[:, :-1]
    np.testing.assert_allclose(gaps, rest[:, 1:-1], atol=1e-3)
    np.testing.assert_allclose(rest[:, ::3], SETTLE, atol=1e-6)
    assert np.delete(rest, np.s_[::3], axis=1).max() <= SETTLE + 1e-6
    np.testing.assert_array_equal(few.refused, np.asarray(few.motion.gap) <= 0)


@pytest.mark.slow
def test_the_check_sees_a_robot_in_the_wall_and_too_much_haste(few):
    """The same missions 0.8 m further ahead; and in nine tenths of the time."""
    trajectory = few.motion.trajectory
    ahead = np.asarray(trajectory.points).copy()
    ahead[..., 0] += 0.8
    moved = dataclasses.replace(trajectory, points=ahead)
    found = check(dataclasses.replace(few, motion=few.motion._replace(trajectory=moved)))
    assert all(one.collides for one in found)
    hurry = jax.vmap(slowed)(trajectory, np.full(trajectory.start.shape, 0.9, np.float32))
    hurried = few.motion._replace(trajectory=jax.tree.map(np.asarray, hurry))
    assert check(dataclasses.replace(few, motion=hurried))[0].acceleration > 1.05


@pytest.mark.slow
@pytest.mark.parametrize("wall", ["flat", "corner", "cylinder", "objects", "room"])
def test_two_hundred_missions(wall):
    missions = random_missions(wall, 40)
    assert missions.refused.mean() <= _REFUSED
    _hold(check(missions))
