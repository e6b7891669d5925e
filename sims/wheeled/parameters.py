"""The physical parameters of fidelity `wheeled`: all are traced, so that a sweep compiles nothing anew."""

import jax.numpy as jnp
import mujoco
from jaxtyping import Array, Float

from sims.dynamics.parameters import GRAVITY_ERROR, POSITION_RATE, Links, links_of

# Sliding friction of rubber on a workshop's concrete floor [-].
FRICTION = 0.8
# Time constant of a loaded tyre [s], twice the time step at least: these are hard rubber, 0.7 mm flat.
TYRE = 0.02
# Rate at which a tread's slip dies out where friction can hold it [1/s].
GRIP = 10.0


class WheeledPhysics(Links):
    """A robot on its wheels, and the floor.

    Joints: steering axis and axle of each wheel in turn, then the arm's.
    position_gain: kp of the servos [N m/rad]. pushed: mass by which the drives feed acceleration forward
    [kg]. friction: of treads on the floor [-]. tyre: time constant of a loaded tyre [s], twice the time step
    at least. grip: rate at which slip dies out where friction holds [1/s].
    """

    position_gain: Float[Array, " joints"]
    pushed: Float[Array, ""]
    friction: Float[Array, ""]
    tyre: Float[Array, ""]
    grip: Float[Array, ""]


def wheeled_physics(
    rolling: mujoco.MjModel,
    *,
    friction: float = FRICTION,
    position_rate: float = POSITION_RATE,
    gravity_error: float = GRAVITY_ERROR,
) -> WheeledPhysics:
    """The parameters of a `wheeled_model`; position_rate: kp over kv [1/s]."""
    links = links_of(rolling)
    return WheeledPhysics(
        **links,
        position_gain=position_rate * links["velocity_gain"],
        pushed=jnp.asarray(rolling.body_mass.sum()),
        gravity_error=jnp.asarray(gravity_error, float),
        friction=jnp.asarray(friction, float),
        tyre=jnp.asarray(TYRE, float),
        grip=jnp.asarray(GRIP, float),
    )
