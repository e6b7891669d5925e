"""The physical parameters of fidelity `wheeled`: all are traced, so that a sweep compiles nothing anew."""

import equinox as eqx
import jax.numpy as jnp
import mujoco
import numpy as np
from jaxtyping import Array, Float

from sims.dynamics.parameters import GRAVITY_ERROR, POSITION_RATE

# Sliding friction of rubber on a workshop's concrete floor [-].
FRICTION = 0.8
# Time constant of a loaded tyre [s], twice the time step at least: these are hard rubber, 0.7 mm flat.
TYRE = 0.02
# Rate at which a tread's slip dies out where friction can hold it [1/s].
GRIP = 10.0


class WheeledPhysics(eqx.Module):
    """Links, joints and servos of a robot on its wheels, and the floor.

    mass [kg], center of mass in the link's frame [m], inertia: principal, about it [kg m^2]; one row a link,
    the base first. Joints: steering axis and axle of each wheel in turn, then the arm's. armature [kg m^2 or
    kg], damping: viscous friction [N m s/rad or N s/m]. velocity_gain: kv of the servos, position_gain: kp.
    force_limit: of the motors, for servo and balanced weight together [N m or N]. pushed: mass by which the
    drives feed acceleration forward [kg]. gravity [m/s^2]: on a sloping floor it leans. gravity_error: share
    of the arm's weight that is not compensated. friction: of treads on the floor [-]. tyre: time constant of
    a loaded tyre [s], twice the time step at least. grip: rate at which slip dies out where friction holds
    [1/s].
    """

    mass: Float[Array, " links"]
    center: Float[Array, "links 3"]
    inertia: Float[Array, "links 3"]
    armature: Float[Array, " joints"]
    damping: Float[Array, " joints"]
    velocity_gain: Float[Array, " joints"]
    position_gain: Float[Array, " joints"]
    force_limit: Float[Array, " joints"]
    pushed: Float[Array, ""]
    gravity: Float[Array, "3"]
    gravity_error: Float[Array, ""]
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
    gain = -rolling.actuator_biasprm[:, 2]
    return WheeledPhysics(
        mass=jnp.asarray(rolling.body_mass[1:]),
        center=jnp.asarray(rolling.body_ipos[1:]),
        inertia=jnp.asarray(rolling.body_inertia[1:]),
        armature=jnp.asarray(rolling.dof_armature[6:]),
        damping=jnp.asarray(np.reshape(rolling.dof_damping, (rolling.nv, -1))[6:, 0]),
        velocity_gain=jnp.asarray(gain),
        position_gain=jnp.asarray(position_rate * gain),
        force_limit=jnp.asarray(rolling.actuator_forcerange[:, 1]),
        pushed=jnp.asarray(rolling.body_mass.sum()),
        gravity=jnp.asarray(np.array(rolling.opt.gravity)),
        gravity_error=jnp.asarray(gravity_error, float),
        friction=jnp.asarray(friction, float),
        tyre=jnp.asarray(TYRE, float),
        grip=jnp.asarray(GRIP, float),
    )
