"""One compiled program of fidelity `wheeled` for all its tests: physics, worlds and commands are traced."""

from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.compiling import batched
from opt.controller import Command
from sims.limits import robot_limits
from sims.noise import noise_preset
from sims.odometry import Slip
from sims.robots import load_robot, robot_model
from sims.wheeled import wheeled
from sims.worlds import standing

DT, STEPS = 0.02, 150


class Ridden(NamedTuple):
    """After each control step: the world, and whether it still holds."""

    base: np.ndarray
    odometry: np.ndarray
    tilt: np.ndarray
    arm: np.ndarray
    holds: np.ndarray


class Bench:
    """Robots that are told twists and joint speeds, `STEPS` control steps in each of many worlds."""

    def __init__(self):
        self.robot = load_robot()
        self.limits = robot_limits(self.robot, clearance=False)
        self.fidelity = wheeled(robot_model(), np.asarray(self.robot.home, float))
        self.run = batched(self._one, in_axes=(None, 0, 0, 0, 0, 0), chunk=4)

    def _one(self, limits, physics, slip, told, steer, arm):
        fidelity = eqx.tree_at(lambda f: f.physics, self.fidelity, physics)
        noise, home = noise_preset("none").odometry, self.robot.home
        world = fidelity.begin(standing(jnp.zeros(3), home, slip, 4))

        def step(world, row):
            command = Command(*row)
            world = fidelity.step(limits, noise, world, command, jnp.zeros(3), jnp.asarray(DT))
            holds = fidelity.holds(limits, world)
            return world, Ridden(world.base, world.odometry, world.tilt, world.arm, holds)

        return jax.lax.scan(step, world, (told, steer, arm))[1]

    def __call__(self, told, steer=None, arm=None, *, physics=None, steering=0.0, radius=0.0):
        """told, steer: [worlds, STEPS, 3], in the base's frame. arm: [worlds, STEPS, joints], at rest where
        it is not given. physics: one a world, or one for all.
        """
        count, one = len(told), jnp.ones((len(told), 4))
        physics = self.fidelity.physics if physics is None else physics
        if physics.mass.ndim == 1:
            physics = jax.tree.map(lambda x: jnp.broadcast_to(x, (count, *x.shape)), physics)
        slip = Slip(steering * one, radius * one)
        still = np.zeros((count, STEPS, len(self.robot.home)))
        rows = (told, told if steer is None else steer, still if arm is None else arm)
        rows = (jnp.asarray(x, jnp.float32) for x in rows)
        return jax.tree.map(np.asarray, self.run(self.limits, physics, slip, *rows))


@pytest.fixture(scope="package")
def bench():
    return Bench()


def constant(*twists):
    """Each twist from the start to half a second before the end, within 0.5 m/s^2 and 1 rad/s^2; wheels turn
    in the first second. [worlds, STEPS, 3] told, and steered.
    """
    told = np.zeros((len(twists), STEPS, 3))
    steer = np.repeat(np.asarray(twists, float)[:, None], STEPS, axis=1)
    for k, twist in enumerate(np.asarray(twists, float)):
        gather = max(np.abs(twist[:2]).max() / 0.5, abs(twist[2]) / 1.0, DT)
        time = np.arange(STEPS) * DT
        share = np.clip((time - 1.0) / gather, 0, 1) * np.clip((time[-1] - 0.5 - time) / gather, 0, 1)
        told[k] = share[:, None] * twist
    return told, steer
