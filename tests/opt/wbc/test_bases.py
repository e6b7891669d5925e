"""Bases that cannot go sideways, and an arm without a base, in a closed loop."""

import dataclasses

import jax.numpy as jnp
import numpy as np

from jaxpaint.decisions import default_thresholds
from jaxpaint.kinematics import arm_chain, no_parts
from jaxpaint.steering import differential, wrap
from opt.wbc import ControlStatus, default_settings
from opt.wbc.polar import polar_twist
from sims.odometry import moved
from tests.opt.wbc.conftest import DT, Trial, closed_loop, straight

STEPS = 1000
ONE = jnp.float32(1)


def test_a_differential_base_turns_goes_and_turns_again(robot, limits, brush):
    base = differential(0.5 * ONE, 0.1 * ONE, ONE)
    run = closed_loop(dataclasses.replace(limits, drive=base), STEPS, speed=0.03)
    rows = straight(brush.p, [0, 0.03, 0], STEPS, brush.R)
    start = np.zeros(3, "f")
    beside = default_thresholds(release_margin=0.15, halt_travel=5.0, low_speed_scale=6.0)
    trial = Trial(default_settings(), beside, rows, np.array([0, 0.5, 0], "f"), start, np.asarray(robot.home))
    creeping = trial._replace(thresholds=default_thresholds(low_speed_scale=0.0, halt_travel=np.inf))
    seen = run(trial, creeping)
    G = np.asarray(base.nonholonomic_rows)[0]
    velocity, yaw = seen.base_velocity, seen.base[..., 2]
    c, s = np.cos(yaw), np.sin(yaw)
    across = (c * velocity[..., 1] - s * velocity[..., 0]) + G[2] * velocity[..., 2]
    assert np.abs(across).max() < 1e-4  # what is commanded needs no slip
    assert (seen.status == ControlStatus.SOLVED).mean(1).min() > 0.98
    assert np.isin(seen.status, [ControlStatus.SOLVED, ControlStatus.NOT_CONVERGED]).all()
    assert seen.error.max() < 0.02
    assert np.abs(seen.base[0, -1] - trial.station).max() < 0.03
    assert np.abs(yaw[0]).max() > 1.0  # it turned on its way


def test_a_goal_beside_the_base_asks_it_to_turn_first():
    base = differential(0.5 * ONE, 0.1 * ONE, ONE)
    law = np.asarray(
        polar_twist(
            jnp.zeros(3),
            jnp.asarray([0, 0.5, 0]),
            base.nonholonomic_rows[0],
            0.3 * ONE,
            1.5 * ONE,
            (0.03 * ONE, ONE),
        )
    )
    assert law[0] == 0 and law[2] > 0 and law[1] == -0.1 * law[2]


def test_the_polar_law_reaches_every_pose():
    rng = np.random.default_rng(1)
    for axle in (0.0, 0.2):
        row = jnp.asarray([0, 1, axle])
        for goal in rng.uniform([-1, -1, -3], [1, 1, 3], (4, 3)):
            pose, goal = jnp.zeros(3), jnp.asarray(goal, jnp.float32)
            for _ in range(700):
                twist = polar_twist(pose, goal, row, 0.3 * ONE, 1.5 * ONE, (0.03 * ONE, 0.2 * ONE))
                assert abs(float(row @ twist)) < 1e-6
                pose = moved(pose, twist * DT)
            off = pose - goal
            assert np.abs(np.asarray(off.at[2].set(wrap(off[2])))).max() < 0.02, goal


def test_an_arm_without_a_base_follows_its_path(robot, limits, brush):
    chain = arm_chain(limits.chain, jnp.zeros(3))
    alone = dataclasses.replace(
        limits,
        chain=chain,
        base_speed=limits.base_speed[:0],
        base_acceleration=limits.base_acceleration[:0],
        parts=no_parts(chain),
    )
    assert alone.base_size == 0 and alone.arm_joints == 6
    run = closed_loop(alone, 200)
    rows = straight(brush.p, [0, 0.03, 0.04], 200, brush.R)
    trial = Trial(
        default_settings(),
        default_thresholds(),
        rows,
        np.ones(3, "f"),
        np.zeros(3, "f"),
        np.asarray(robot.home),
    )
    seen = run(trial, trial)
    assert not seen.status.any()
    assert seen.error[:, 25:].max() < 1e-3
    assert not seen.twist.any() and seen.halted.all()
