"""Rests at via points: as long as the wheels need, and no longer."""

import numpy as np
import pytest

from sims.painting.via_rests import via_rests
from sims.robots import load_robot


@pytest.fixture(scope="module")
def robot():
    return load_robot()


def rests(robot, bases, arm, duration):
    """Of one world whose first, and every third, point is no via point."""
    points = np.zeros((1, len(bases), 9))
    points[0, :, :3] = bases
    points[0, :, 3] = arm
    return via_rests(robot, points, np.array([duration], float), 3, 0.6)[0]


def test_a_base_that_turns_off_waits_for_its_wheels(robot):
    """Back, aside and forwards: a quarter turn at 3 rad/s each; and the same with a turn on the way back."""
    found = rests(robot, [[0, 0, 0], [-1, 0, 0], [-1, 1, 0], [0, 1, 0]], 0, [3, 3, 3])
    np.testing.assert_allclose(found[[0, 3]], 0.6)
    np.testing.assert_allclose(found[1:3], np.pi / 2 / 3 + 0.04, atol=0.025)
    slight = rests(robot, [[0, 0, 0], [-1, 0, 0], [-2, 0.3, 0], [-3, 1, 0]], 0, [3, 3, 3])
    assert (slight[1:3] < 0.2).all() and (slight[1:3] > 0.04).all()


def test_nothing_waits_where_the_base_stands_still_before_or_after(robot):
    """The arm draws back, the base goes, the arm reaches out; the arm moves between two ways of the base."""
    found = rests(robot, [[0, 0, 0], [0, 0, 0], [0, 1, 0], [0, 1, 0]], [0, 1, 0, 1], [0.2, 3, 0.2])
    np.testing.assert_array_equal(found[1:3], 0)
    found = rests(robot, [[0, 0, 0], [-1, 0, 0], [-1, 0, 0], [-1, 1, 0]], [0, 0, 1, 1], [3, 0.3, 3])
    assert found[1] == 0 and found[2] == pytest.approx(np.pi / 2 / 3 + 0.04 - 0.3, abs=0.025)
    none = rests(robot, [[0, 0, 0]] * 3 + [[1, 0, 0]], 0, [0, 0, 2])
    np.testing.assert_array_equal(none[1:3], 0)
