"""Bases that are told twists."""

import numpy as np

from experiments.fidelities import MOTIONS, follow, moves_of, random_moves, way_of
from sims.limits import robot_limits
from sims.noise import noise_preset
from sims.robots import load_robot
from sims.worlds import Kinematic


def told_to_kinematic(told, steer, noise="none"):
    robot, preset = load_robot(), noise_preset(noise).odometry
    limits = robot_limits(robot, clearance=False)
    rng = np.random.default_rng(0)
    return follow(Kinematic(), limits, preset, robot.home, told, steer, rng.normal(size=told.shape))


def test_kinematic_bases_go_where_they_are_told():
    told, steer = (np.stack(x) for x in zip(*(motion.rows() for motion in MOTIONS), strict=True))
    found = told_to_kinematic(told, steer)
    for k in range(len(MOTIONS)):
        np.testing.assert_allclose(found.base[k], way_of(told[k]), atol=2e-3)
    np.testing.assert_allclose(found.base, found.odometry, atol=1e-5)


def test_moves_know_their_way_and_how_far_axes_turned():
    told, steer = (np.stack([x, x]) for x in random_moves(3, seed=1))
    moves = moves_of(told_to_kinematic(told, steer, "s1-simulation"))
    assert moves.error.shape == (6, 3) and (moves.way > 0.01).all() and (moves.turned > 0.05).all()
    assert 1e-5 < np.abs(moves.error[:, :2]).mean() < 1e-2
