"""Turning wheels at the corners of a base's path: quarter turns at 3 rad/s."""

import mujoco
import numpy as np
import pytest

from experiments.motion.wheel_turns import wheel_turns
from sims.robots.load import REFERENCE

MODEL = mujoco.MjModel.from_xml_path(str(REFERENCE))
QUARTER = np.pi / 2 / 3


def turns(points, duration, corner):
    return wheel_turns(MODEL, np.array(points, float), np.array(duration, float), np.array(corner, bool))


def test_corners_cost_what_the_wheels_turn_and_rests_cost_nothing():
    square = [[0, 0, 0], [-1, 0, 0], [-1, 1, 0], [0, 1, 0]]
    assert turns(square, [2, 2, 2], [0, 1, 1, 0]) == pytest.approx(2 * QUARTER)
    assert turns(square, [2, 2, 2], [0, 1, 0, 0]) == pytest.approx(QUARTER)
    assert turns([[0, 0, 0], [-1, 0, 0], [0, 0, 0]], [2, 2], [0, 1, 0]) == pytest.approx(0, abs=1e-9)
    # the base turned by a quarter: what was aside is now ahead
    assert turns([[0, 0, 0], [0, 1, 0], [0, 2, np.pi / 2]], [2, 2], [0, 1, 0]) > 0


def test_while_the_arm_alone_moves_the_wheels_can_turn():
    stops = [[0, 0, 0], [-1, 0, 0], [-1, 0, 0], [-1, 1, 0]]
    assert turns(stops, [2, 0.2, 2], [0, 1, 1, 0]) == pytest.approx(QUARTER - 0.2)
    assert turns(stops, [2, 0.9, 2], [0, 1, 1, 0]) == 0
