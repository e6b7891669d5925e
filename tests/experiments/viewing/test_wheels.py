"""Wheels turn to where the base goes, and roll as far as it goes."""

from pathlib import Path

import numpy as np
import pytest

from experiments.viewing.wheels import wheel_angles
from sims.robots import robot_model

MECANUM = Path(__file__).resolve().parents[2] / "robots" / "mecanum.xml"
TIME = np.arange(101) * 0.08


@pytest.fixture(scope="module")
def model():
    return robot_model()


def along(x=0.0, y=0.0, yaw=0.0):
    return np.outer(TIME, [x, y, yaw])


def test_straight_ahead(model):
    angles = wheel_angles(model, TIME, along(x=0.1))
    assert len(angles) == 8
    for name, angle in angles.items():
        if name.startswith("steer_"):
            np.testing.assert_allclose(angle, 0, atol=1e-9)
        else:
            np.testing.assert_allclose(angle[-1], 0.1 * TIME[-1] / 0.10, rtol=1e-6)


def test_sideways_by_a_quarter_turn_and_back_without_turning(model):
    there = along(y=-0.1)
    there[50:] = there[50] + 0.1 * (TIME[50:, None] - TIME[50]) * [0, 1, 0]
    angles = wheel_angles(model, TIME, there)
    steer, roll = angles["steer_fl"], angles["wheel_fl"]
    np.testing.assert_allclose(np.abs(steer), np.pi / 2, atol=1e-6)
    assert np.ptp(steer) < 1e-6, "it rolls backwards instead"
    assert abs(roll[-1]) < 0.1 * abs(roll[50])


def test_turning_on_the_spot_all_wheels_are_on_a_circle(model):
    angles = wheel_angles(model, TIME, along(yaw=0.2))
    assert abs(angles["steer_fl"][-1]) == pytest.approx(np.arctan2(0.28, 0.22))
    assert angles["steer_fl"][-1] == pytest.approx(-angles["steer_fr"][-1])


def test_a_base_at_rest_keeps_its_wheels(model):
    for angle in wheel_angles(model, TIME, along()).values():
        assert not angle.any()
    assert wheel_angles(model, TIME[:1], along()[:1]) == {}


def test_wheels_that_do_not_steer_are_left():
    assert wheel_angles(robot_model(MECANUM), TIME, along(x=0.1)) == {}
