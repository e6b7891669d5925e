"""One compiled program of fidelity `dynamic` for all its tests: physics, worlds and plans are traced."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.compiling import batched
from opt.plan import Samples
from opt.trajectory import TrajectoryController
from sims.dynamics import dynamic
from sims.limits import robot_limits
from sims.noise import noise_preset
from sims.odometry import Slip
from sims.robots import load_robot, robot_model
from sims.rollout import run_block, start
from sims.worlds import standing

DT, RECORDS = 0.02, 13  # 52 control steps
STEPS = 4 * RECORDS


class Bench:
    """Runs velocity plans in many worlds."""

    def __init__(self):
        self.model, self.robot = robot_model(), load_robot()
        self.limits = robot_limits(self.robot)
        self.fidelity = dynamic(self.model)
        self.noise = noise_preset("none").odometry
        self.run = batched(self._one, in_axes=(None, None, None, 0, 0, 0, 0), chunk=4)

    def _one(self, limits, noise, gain, physics, world, slip, rows):
        fidelity = eqx.tree_at(lambda f: f.physics, self.fidelity, physics)
        plan = Samples(rows, jnp.asarray(DT), jnp.asarray(0.0))
        follow = TrajectoryController(limits.chain, plan, gain, jnp.asarray(10.0))
        base, arm = world[:3], world[3:]
        state = start(follow, fidelity, standing(base, arm, slip, 4))
        key = jax.random.key(0)
        return run_block(follow, fidelity, limits, noise, jnp.asarray(DT), state, key, records=RECORDS)

    def __call__(self, rows, *, physics=None, world=None, slip=1.0, noise=None, gain=0.0):
        """rows: [worlds, STEPS, 19]. physics: one a world, or one for all. world: q at the start."""
        count = len(rows)
        one = jnp.ones((count, 4))
        physics = self.fidelity.physics if physics is None else physics
        if physics.mass.ndim == 1:
            physics = jax.tree.map(lambda x: jnp.broadcast_to(x, (count, *x.shape)), physics)
        home = jnp.asarray(np.tile(self.robot.at_home(jnp.zeros(3)), (count, 1)))
        return self.run(
            self.limits,
            self.noise if noise is None else noise,
            jnp.asarray(gain),
            physics,
            home if world is None else jnp.asarray(world, jnp.float32),
            Slip(0 * one, (slip - 1) * one),
            jnp.asarray(rows, jnp.float32),
        )


@pytest.fixture(scope="package")
def bench():
    return Bench()


@pytest.fixture
def resting(bench):
    """Rows of a plan that stays at home. [1, STEPS, 19]"""
    rows = np.zeros((1, STEPS, 19))
    rows[..., :9] = bench.robot.at_home(jnp.zeros(3))
    return rows
