"""The physical parameters of fidelity `dynamic`: all are traced, so that a sweep compiles nothing anew."""

import equinox as eqx
import jax.numpy as jnp
import mujoco
import numpy as np
from jaxtyping import Array, Float

# Position loop of the arm's servos over their velocity loop [1/s]: industrial arms have 10 to 30.
POSITION_RATE = 20.0
# Share of the arm's weight that the arm's own compensation gets wrong, as with a tool of half a kilogram that
# it was not told of [-].
GRAVITY_ERROR = 0.05


class Physics(eqx.Module):
    """Links, joints and servos of a planar base (first 3 joints) and an arm.

    mass [kg], center of mass in the link's frame [m], inertia: principal, about it [kg m^2]; one row a link,
    the base first. armature [kg m^2 or kg], damping: viscous friction [N m s/rad or N s/m]. velocity_gain: kv
    of the servos [N m s/rad or N s/m]. position_gain: kp of the arm's [N m/rad]. force_limit: of the motors,
    for servo and balanced weight together, friction not counted [N m or N]. pushed: inertia by which the
    base's drives feed acceleration forward [kg, kg m^2]. gravity [m/s^2]. gravity_error: share of the weight
    that is not compensated.
    """

    mass: Float[Array, " links"]
    center: Float[Array, "links 3"]
    inertia: Float[Array, "links 3"]
    armature: Float[Array, " joints"]
    damping: Float[Array, " joints"]
    velocity_gain: Float[Array, " joints"]
    position_gain: Float[Array, " arm"]
    force_limit: Float[Array, " joints"]
    pushed: Float[Array, "3"]
    gravity: Float[Array, "3"]
    gravity_error: Float[Array, ""]


def physics_of(
    planar: mujoco.MjModel, *, position_rate: float = POSITION_RATE, gravity_error: float = GRAVITY_ERROR
) -> Physics:
    """The parameters of a `planar_model`; position_rate: kp over kv of the arm [1/s]."""
    gain = -planar.actuator_biasprm[:, 2]
    return Physics(
        mass=jnp.asarray(planar.body_mass[1:]),
        center=jnp.asarray(planar.body_ipos[1:]),
        inertia=jnp.asarray(planar.body_inertia[1:]),
        armature=jnp.asarray(planar.dof_armature),
        damping=jnp.asarray(np.reshape(planar.dof_damping, (planar.nv, -1))[:, 0]),
        velocity_gain=jnp.asarray(gain),
        position_gain=jnp.asarray(position_rate * gain[3:]),
        force_limit=jnp.asarray(planar.actuator_forcerange[:, 1]),
        pushed=jnp.asarray(planar.body_mass.sum() * np.array([1.0, 1.0, 0.0])),
        gravity=jnp.asarray(np.array(planar.opt.gravity)),
        gravity_error=jnp.asarray(gravity_error, float),
    )
