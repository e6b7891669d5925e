"""Random missions: no limit exceeded, no jump, no touch, and nearly as fast as can be."""

import dataclasses

import equinox as eqx
import jax
import numpy as np
import pytest

from experiments.motion import check, random_missions
from experiments.motion.missions import TARGETS
from jaxpaint.trajectories import slowed

# Acceleration builds up over a twentieth of a second at the quickest, from nothing to the limit.
_BASE, _ARM = 0.5, 8.0


def _hold(checked):
    for one in checked:
        assert max(one.speed, one.acceleration, one.torque) <= 1.001
        assert one.distance > 0
        # from one millisecond to the next a fortieth of the limit, since it builds up over 0.04 s at least
        assert one.jump[0] < _BASE / 40 * 1.1 + 1e-3 and one.jump[1] < _ARM / 40 * 1.1
    moving, bound = (np.array([getattr(one, name) for one in checked]) for name in ("moving", "bound"))
    assert (moving >= bound * (1 - 0.01)).all()
    assert moving.sum() <= 1.15 * bound.sum()


@pytest.fixture(scope="module")
def few():
    return random_missions("corner", 6)


@pytest.mark.slow
def test_a_few_missions_before_a_corner(few):
    _hold(check(few))


@pytest.mark.slow
def test_they_touch_with_the_brush_and_stop_everywhere(few):
    """The missions are what they say: the brush at the wall, at rest at each waypoint, via points between."""
    start, segments = np.asarray(few.trajectory.start, float), np.asarray(few.trajectory.segments, float)
    rest = np.asarray(few.trajectory.rest, float)
    # no via point but where the way is bent, and no move but where a waypoint differs from the one before
    moves = np.abs(np.diff(few.waypoints, axis=1)).max(-1) > 0
    np.testing.assert_array_equal(segments[:, 2::3] > 0, moves)
    assert moves.sum(1).min() >= TARGETS + 1 and moves.sum(1).max() >= TARGETS + 5
    gaps = start[:, 1:] - start[:, :-1] - segments[:, :-1]
    np.testing.assert_allclose(gaps, rest[:, 1:-1], atol=1e-3)
    assert (rest[:, ::3] > 0).all()
    assert (few.gap > 0).all()


@pytest.mark.slow
def test_the_check_sees_a_robot_in_the_wall_and_too_much_haste(few):
    """The same missions 0.8 m further ahead; and in nine tenths of the time."""
    ahead = np.asarray(few.trajectory.points).copy()
    ahead[..., 0] += 0.8
    moved = eqx.tree_at(lambda m: m.points, few.trajectory, ahead)
    found = check(dataclasses.replace(few, trajectory=moved))
    assert min(one.distance for one in found) < 0
    hurry = jax.vmap(slowed)(few.trajectory, np.full(few.trajectory.start.shape, 0.9, np.float32))
    hurried = jax.tree.map(np.asarray, hurry)
    assert check(dataclasses.replace(few, trajectory=hurried))[0].acceleration > 1.05


@pytest.mark.slow
@pytest.mark.parametrize(("wall", "count"), [("flat", 67), ("corner", 67), ("cylinder", 66)])
def test_two_hundred_missions(wall, count):
    _hold(check(random_missions(wall, count)))
