"""The robot on its wheels for MuJoCo in C: where it comes to rest, and what our steps are held against."""

from copy import deepcopy

import mujoco
import numpy as np

from sims.wheeled.parameters import GRIP, TYRE, WheeledPhysics

# Enough for Newton's method to end by its own tolerance.
_ITERATIONS, _LINE_SEARCH = 100, 50


def with_contacts(
    rolling: mujoco.MjModel, *, friction: float, tyre: float = TYRE, grip: float = GRIP
) -> mujoco.MjModel:
    """A copy of a `wheeled_model` with the contact parameters of `WheeledPhysics`, solved to the end."""
    model = deepcopy(rolling)
    model.opt.iterations, model.opt.ls_iterations = _ITERATIONS, _LINE_SEARCH
    model.pair_friction[:] = [friction, friction, 0, 0, 0]
    model.pair_solref[:] = [tyre, 1.0]
    model.pair_solreffriction[:] = [0, -grip]
    return model


def in_c(rolling: mujoco.MjModel, physics: WheeledPhysics, timestep: float) -> mujoco.MjModel:
    """What steps by `mujoco.mj_step` as `WheeledEngine.advance` does, with links as the model has them.

    The damping of joints and servos acts as inertia for a step, which makes Euler's step implicit in it, and
    contacts know it. MuJoCo's own implicit damping comes after its contacts. timestep [s].
    """
    model = with_contacts(
        rolling, friction=float(physics.friction), tyre=float(physics.tyre), grip=float(physics.grip)
    )
    model.opt.timestep = timestep
    model.actuator_biasprm[:, 1] = -np.asarray(physics.position_gain)
    damping = np.asarray(physics.velocity_gain) + np.asarray(physics.damping)
    model.dof_armature[-len(damping) :] += timestep * damping
    return model
