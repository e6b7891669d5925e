"""The bound itself: the trapezoid in closed form, and a path whose limits change along it."""

import numpy as np
import pytest

from experiments.motion.topp import fastest_time

NODES = 401


def straight(length, speed, acceleration, force=np.inf, pull=0.0, damping=0.0):
    """One joint along a line: rows of acceleration, and of a motor that also holds a pull."""
    one = np.ones((1, NODES, 1))
    A = np.concatenate([length * one, length * one], -1)
    limit = np.concatenate([acceleration * one, min(force, 1e9) * one], -1)
    offset = np.concatenate([0 * one, pull * one], -1)
    drag = np.concatenate([0 * one, damping * length * one], -1)
    return fastest_time(A, 0 * A, offset, limit, np.full((1, NODES), (speed / length) ** 2), drag)[0]


@pytest.mark.parametrize(
    ("length", "speed", "acceleration"), [(1, 0.5, 0.5), (0.3, 0.5, 0.5), (2.0, 3.1, 8.0)]
)
def test_a_straight_way_takes_as_long_as_the_trapezoid(length, speed, acceleration):
    peak = min(speed, np.sqrt(length * acceleration))
    bound = length / peak + peak / acceleration
    assert straight(length, speed, acceleration) == pytest.approx(bound, rel=2e-3)


def test_a_motor_that_holds_a_pull_speeds_up_slowly_and_brakes_fast():
    """Up at 3 - 1, down at 3 + 1: t = sqrt(2 L (1/2 + 1/4))."""
    assert straight(1.0, 100.0, 100.0, 3.0, 1.0) == pytest.approx(np.sqrt(2 * (1 / 2 + 1 / 4)), rel=2e-3)


def test_damping_slows_the_start_and_helps_to_brake():
    """v' = 1 - v, then v' = -1 - v: after t at full force v = 1 - exp(-t), and it stops log(1 + v) later."""
    up = 1.0
    v = 1 - np.exp(-up)
    down = np.log(1 + v)
    length = (up - v) + (v - down)
    assert straight(length, 100.0, 100.0, 1.0, 0.0, 1.0) == pytest.approx(up + down, rel=5e-3)


def test_a_bend_of_the_path_is_taken_at_the_speed_that_its_acceleration_allows():
    """A quarter circle of radius r: across the way, v^2 / r stays below the limit in x and y."""
    s = np.linspace(0, 1, NODES)
    angle, r, most = s * np.pi / 2, 1.0, 1.0
    rate = np.pi / 2
    first = r * rate * np.stack([-np.sin(angle), np.cos(angle)], -1)
    second = -r * rate**2 * np.stack([np.cos(angle), np.sin(angle)], -1)
    limit = np.full((1, NODES, 2), most)
    found = fastest_time(first[None], second[None], 0 * limit, limit, np.full((1, NODES), 1e6))[0]
    # no faster than if it were straight along the diagonal, where both axes accelerate at once
    free = 2 * np.sqrt(np.pi / 2 * r / (np.sqrt(2) * most))
    assert free < found < 2 * free
    # half the acceleration takes sqrt(2) times as long
    slow = fastest_time(first[None], second[None], 0 * limit, limit / 2, np.full((1, NODES), 1e6))[0]
    assert slow == pytest.approx(np.sqrt(2) * found, rel=1e-3)
