"""The whole-body controller on other arms and bases: a circle on a wall."""

from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.compiling import batched
from jaxpaint.decisions import default_thresholds
from jaxpaint.kinematics import forward
from opt.controller import Measured
from opt.plan import Samples
from opt.wbc import WholeBodyController, default_settings
from sims.limits import robot_limits
from sims.odometry import moved
from sims.robots import load_robot

ROBOTS = Path(__file__).resolve().parents[2] / "robots"
DT, STEPS, RADIUS, SPEED = 0.02, 500, 0.10, 0.03


def circle(brush):
    """Rows of the reference: a circle about a point left of home, up first, at 30 mm/s."""
    angle = np.arange(STEPS) * DT * SPEED / RADIUS
    zero = np.zeros(STEPS)
    place = np.asarray(brush.p) + RADIUS * np.stack([zero, np.cos(angle) - 1, np.sin(angle)], axis=1)
    velocity = SPEED * np.stack([zero, -np.sin(angle), np.cos(angle)], axis=1)
    turn = np.tile(np.asarray(brush.R).reshape(-1), (STEPS, 1))
    rows = np.concatenate([place, turn, velocity, np.zeros((STEPS, 3)), np.ones((STEPS, 1))], axis=1)
    return jnp.asarray(rows, jnp.float32)


@pytest.mark.parametrize("name", ["seven_joints.xml", "mecanum.xml"])
def test_the_brush_follows_a_circle_within_the_limits(name):
    robot = load_robot(ROBOTS / name)
    limits = robot_limits(robot)
    rows = circle(forward(robot.chain, robot.at_home(jnp.zeros(3))))

    def run(limits, rows, base):
        one = jnp.ones(())
        controller = WholeBodyController(
            robot=limits,
            settings=default_settings(arm_joints=robot.home.shape[0]),
            thresholds=default_thresholds(halt_travel=np.inf, release_margin=0.0),
            reference=Samples(rows, DT * one, 0 * one),
            stations=Samples(jnp.asarray([[0.0, 0.2, 0.0]] * 2), one, 0 * one),
            speed=SPEED * one,
            pace=one,
            duration=STEPS * DT * one,
        )

        def step(carry, clock):
            memory, base, arm, angle = carry
            decision, memory = controller.decide(memory, Measured(base, arm, angle), clock, DT * one)
            command = decision.command
            off = decision.planned - forward(limits.chain, jnp.concatenate([base, arm])).p
            angle = limits.drive.steered(command.steer_twist, angle, DT * one)
            rolled = limits.drive.twist(angle, limits.drive.rolled(command.base_twist, angle))
            after = memory, moved(base, rolled * DT), arm + DT * command.arm_velocity, angle
            return after, (jnp.sqrt((off**2).sum()), command.arm_velocity, rolled, arm, decision.fault)

        start = Measured(base, robot.home, jnp.zeros(limits.drive.size))
        begin = controller.initial(start), base, robot.home, start.wheel_angle
        return jax.lax.scan(step, begin, jnp.arange(STEPS) * DT)[1]

    off, speed, twist, arm, fault = (
        np.asarray(x) for x in batched(run, in_axes=(None, None, 0))(limits, rows, jnp.zeros((2, 3)))
    )
    assert not fault.any()
    assert off[:, 25:].max() < 0.003
    assert (np.abs(speed) <= np.asarray(robot.speed_limit[3:]) * 1.001).all()
    assert (np.abs(np.diff(speed, axis=1)) <= np.asarray(robot.acceleration_limit[3:]) * DT * 1.01).all()
    assert ((arm >= np.asarray(robot.lower)) & (arm <= np.asarray(robot.upper))).all()
    assert np.abs(twist[..., 1]).max() > 0.01  # the base helped, sideways
