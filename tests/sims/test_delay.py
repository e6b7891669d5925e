"""Commands that arrive late."""

import jax.numpy as jnp
import numpy as np
import pytest

from opt.controller import Command
from sims.delay import Delayed, inner_fidelity
from sims.limits import robot_limits
from sims.noise import noise_preset
from sims.odometry import no_slip
from sims.robots import load_robot
from sims.worlds import Fidelity, Kinematic, standing


class Told(Fidelity):
    """Shows the command that arrived as the arm."""

    def begin(self, world):
        return world

    def step(self, robot, noise, world, command, shock, dt):
        import dataclasses

        return dataclasses.replace(world, arm=command.arm_velocity)


@pytest.mark.parametrize("latency", [0.0, 0.02, 0.05, 1.0])
def test_a_ramp_arrives_late_by_the_latency(latency):
    robot, dt = load_robot(), 0.02
    fidelity = Delayed(Told(), jnp.asarray(latency))
    world = fidelity.begin(standing(jnp.zeros(3), robot.home, no_slip(4), 4))
    limits, noise = robot_limits(robot, clearance=False), noise_preset("none").odometry
    for k in range(20):
        ramp = Command(jnp.zeros(3), jnp.zeros(3), jnp.full(6, float(k)))
        world = fidelity.step(limits, noise, world, ramp, jnp.zeros(3), jnp.asarray(dt))
    late = min(latency / dt, 7)
    np.testing.assert_allclose(world.arm, 19 - late, atol=1e-5)
    assert inner_fidelity(fidelity) is fidelity.fidelity


def test_beginning_again_keeps_what_waits():
    fidelity = Delayed(Kinematic(), jnp.asarray(0.02))
    world = fidelity.begin(standing(jnp.zeros(3), load_robot().home, no_slip(4), 4))
    assert fidelity.begin(world) is world
