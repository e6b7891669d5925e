"""Bases that are told twists, in any fidelity, with odometry's own errors left out or in."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from jaxpaint.compiling import batched
from opt.controller import Command
from opt.wbc import RobotLimits
from sims.odometry import OdometryNoise, Slip
from sims.worlds import Fidelity, standing


class Followed(NamedTuple):
    """After each control step: where bases are and where odometry has them (x, y [m], yaw [rad]), and how
    they tilt (`World.tilt`).
    """

    base: Float[Array, "*worlds t 3"]
    odometry: Float[Array, "*worlds t 3"]
    tilt: Float[Array, "*worlds t 3"]


def follow(
    fidelity: Fidelity,
    robot: RobotLimits,
    noise: OdometryNoise,
    home: Float[Array, " a"],
    slip: Slip,
    told: Float[np.ndarray, "worlds t 3"],
    steer: Float[np.ndarray, "worlds t 3"],
    shocks: Float[np.ndarray, "worlds t 3"],
    dt: float,
) -> Followed:
    """Every world starts at the origin and is told its own rows. slip: one row a world."""
    return _FOLLOW(fidelity, robot, noise, home, jnp.asarray(dt), slip, told, steer, shocks)


def _one(fidelity: Fidelity, robot: RobotLimits, noise, home, dt, slip, told, steer, shocks) -> Followed:
    wheels = robot.drive.size
    world = fidelity.begin(standing(jnp.zeros(3, home.dtype), home, slip, wheels))

    def step(world, row):
        command = Command(row[0], row[1], jnp.zeros_like(home))
        world = fidelity.step(robot, noise, world, command, row[2], dt)
        return world, Followed(world.base, world.odometry, world.tilt)

    _, found = jax.lax.scan(step, world, (told, steer, shocks))
    return found


_FOLLOW = batched(_one, in_axes=(None, None, None, None, None, 0, 0, 0, 0), chunk=32)
