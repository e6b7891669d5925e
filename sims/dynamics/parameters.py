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


class Links(eqx.Module):
    """Links, joints and servos of any chain, its base first.

    mass [kg], center of mass in the link's frame [m], inertia: principal, about it [kg m^2]; one row a link.
    armature [kg m^2 or kg], damping: viscous friction [N m s/rad or N s/m]. velocity_gain: kv of the servos
    [N m s/rad or N s/m]. force_limit: of the motors, for servo and balanced weight together, friction not
    counted [N m or N]. gravity [m/s^2]: on a sloping floor it leans. gravity_error: share of the arm's weight
    that is not compensated.
    """

    mass: Float[Array, " links"]
    center: Float[Array, "links 3"]
    inertia: Float[Array, "links 3"]
    armature: Float[Array, " joints"]
    damping: Float[Array, " joints"]
    velocity_gain: Float[Array, " joints"]
    force_limit: Float[Array, " joints"]
    gravity: Float[Array, "3"]
    gravity_error: Float[Array, ""]


class Physics(Links):
    """A planar base (first 3 joints) and an arm.

    position_gain: kp of the arm's servos [N m/rad]. pushed: inertia by which the base's drives feed
    acceleration forward [kg, kg m^2].
    """

    position_gain: Float[Array, " arm"]
    pushed: Float[Array, "3"]


def physics_of(
    planar: mujoco.MjModel, *, position_rate: float = POSITION_RATE, gravity_error: float = GRAVITY_ERROR
) -> Physics:
    """The parameters of a `planar_model`; position_rate: kp over kv of the arm [1/s]."""
    links = links_of(planar)
    return Physics(
        **links,
        position_gain=position_rate * links["velocity_gain"][3:],
        pushed=jnp.asarray(planar.body_mass.sum() * np.array([1.0, 1.0, 0.0])),
        gravity_error=jnp.asarray(gravity_error, float),
    )


def links_of(model: mujoco.MjModel) -> dict[str, Array]:
    """What a model itself says of its `Links`, by field; joints: those that servos move, the last ones."""
    joints = slice(model.nv - model.nu, None)
    damping = np.reshape(model.dof_damping, (model.nv, -1))[:, 0]
    values = {
        "mass": model.body_mass[1:],
        "center": model.body_ipos[1:],
        "inertia": model.body_inertia[1:],
        "armature": model.dof_armature[joints],
        "damping": damping[joints],
        "velocity_gain": -model.actuator_biasprm[:, 2],
        "force_limit": model.actuator_forcerange[:, 1],
        "gravity": np.array(model.opt.gravity),
    }
    return {name: jnp.asarray(value) for name, value in values.items()}
