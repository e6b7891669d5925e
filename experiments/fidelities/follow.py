"""Bases that are told twists, in any fidelity."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from jaxpaint.compiling import batched
from opt.controller import Command
from opt.wbc import RobotLimits
from sims.odometry import OdometryNoise, no_slip
from sims.painting.job import CONTROL_PERIOD
from sims.worlds import Fidelity, standing


class Followed(NamedTuple):
    """After each control step: where bases are and where odometry has them (x, y [m], yaw [rad]), how they
    tilt (`World.tilt`), and how far the steering axes have turned, in the mean [rad].
    """

    base: Float[np.ndarray, "worlds t 3"]
    odometry: Float[np.ndarray, "worlds t 3"]
    tilt: Float[np.ndarray, "worlds t 3"]
    steered: Float[np.ndarray, "worlds t"]


def follow(
    fidelity: Fidelity,
    robot: RobotLimits,
    noise: OdometryNoise,
    home: Float[Array, " a"],
    told: Float[np.ndarray, "worlds t 3"],
    steer: Float[np.ndarray, "worlds t 3"],
    shocks: Float[np.ndarray, "worlds t 3"] | None = None,
) -> Followed:
    """Every world starts at the origin on wheels that are as odometry takes them, and is told its own rows.

    fidelity: what is marked by `PerWorld` differs. shocks: of the random walk; none where not given.
    """
    told, steer = (np.asarray(x, np.float32) for x in (told, steer))
    walk = np.zeros_like(told) if shocks is None else np.asarray(shocks, np.float32)
    found = _FOLLOW(fidelity, robot, noise, home, jnp.asarray(CONTROL_PERIOD), told, steer, walk)
    return jax.tree.map(np.asarray, found)


def _one(fidelity: Fidelity, robot: RobotLimits, noise, home, dt, told, steer, shocks) -> Followed:
    slip = no_slip(robot.drive.size, home.dtype)
    world = fidelity.begin(standing(jnp.zeros(3, home.dtype), home, slip, robot.drive.size))

    def step(world, row):
        command = Command(row[0], row[1], jnp.zeros_like(home))
        world = fidelity.step(robot, noise, world, command, row[2], dt)
        return world, Followed(world.base, world.odometry, world.tilt, world.steered)  # pyright: ignore

    return jax.lax.scan(step, world, (told, steer, shocks))[1]


_FOLLOW = batched(_one, in_axes=(None, None, None, None, None, 0, 0, 0), chunk=32)
