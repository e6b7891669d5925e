"""Inertias and torque limits of a chain, read from a compiled MuJoCo model."""

from collections.abc import Sequence

import jax.numpy as jnp
import mujoco
import numpy as np
from jaxtyping import Float

from jaxpaint.kinematics.dynamics import Inertia
from sims.robots.model import at_zero, body_frames, carrier, link_frames, matrix


def inertia_from_model(model: mujoco.MjModel, joints: Sequence[int]) -> Inertia:
    """What each of `joints` (root first) carries; bodies on joints that are not among them count as welded at
    zero, as wheels to their base.
    """
    merged = link_inertias(model, joints)
    dof = model.jnt_dofadr[list(joints)]
    return Inertia(
        mass=jnp.asarray(np.array([m for m, _, _ in merged])),
        center=jnp.asarray(np.stack([c for _, c, _ in merged])),
        tensor=jnp.asarray(np.stack([t for _, _, t in merged])),
        armature=jnp.asarray(model.dof_armature[dof]),
        damping=jnp.asarray(np.asarray(model.dof_damping)[dof].reshape(len(dof), -1)[:, 0]),
        gravity=jnp.asarray(np.array(model.opt.gravity)),
    )


def link_inertias(model: mujoco.MjModel, joints: Sequence[int]) -> list[tuple[float, np.ndarray, np.ndarray]]:
    """Mass [kg], center [m] and tensor about it [kg m^2] behind each joint, in its frame, in float64."""
    links, bodies = link_frames(model, joints), body_frames(model)
    parts: list[list[tuple[float, np.ndarray, np.ndarray]]] = [[] for _ in joints]
    for body in range(1, model.nbody):
        link = carrier(model, body, joints)
        if link is not None and model.body_mass[body] > 0:
            T = (
                np.linalg.inv(links[link])
                @ bodies[body]
                @ matrix(model.body_ipos[body], model.body_iquat[body])
            )
            tensor = T[:3, :3] @ np.diag(model.body_inertia[body]) @ T[:3, :3].T
            parts[link].append((float(model.body_mass[body]), T[:3, 3], tensor))
    return [_merged(part) for part in parts]


def weight_at(
    model: mujoco.MjModel, joints: Sequence[int], q: Float[np.ndarray, " joints"]
) -> Float[np.ndarray, " joints"]:
    """Forces and torques that hold the joints still at `q`, all others at 0 [N, N m]."""
    data = at_zero(model)
    data.qpos[model.jnt_qposadr[list(joints)]] = q
    mujoco.mj_forward(model, data)
    return data.qfrc_bias[model.jnt_dofadr[list(joints)]]


def torque_limits(model: mujoco.MjModel, joints: Sequence[int]) -> Float[np.ndarray, " joints"]:
    """The largest force or torque of each joint's motors [N, N m]: the force ranges of its actuators and of
    the joint itself, infinite where the file sets none.
    """
    return np.array([min(_actuators(model, j), _joint(model, j)) for j in joints])


def _merged(parts: list[tuple[float, np.ndarray, np.ndarray]]) -> tuple[float, np.ndarray, np.ndarray]:
    """Mass, centre and tensor about it of several bodies that move as one (parallel axes)."""
    mass = sum(m for m, _, _ in parts)
    if mass == 0:
        return 0.0, np.zeros(3), np.zeros((3, 3))
    center = sum((m * c for m, c, _ in parts), np.zeros(3)) / mass
    tensor = np.zeros((3, 3))
    for m, c, own in parts:
        d = c - center
        tensor += own + m * (d @ d * np.eye(3) - np.outer(d, d))
    return mass, center, tensor


def _actuators(model: mujoco.MjModel, joint: int) -> float:
    """Sum of the limits of all actuators on a joint, seen at the joint."""
    mine = [
        a
        for a in range(model.nu)
        if model.actuator_trntype[a] == int(mujoco.mjtTrn.mjTRN_JOINT) and model.actuator_trnid[a, 0] == joint
    ]
    return sum(_one_actuator(model, a) for a in mine) if mine else np.inf


def _one_actuator(model: mujoco.MjModel, a: int) -> float:
    gear = abs(float(model.actuator_gear[a, 0]))
    if model.actuator_forcelimited[a]:
        return gear * float(np.abs(model.actuator_forcerange[a]).min())
    direct = not model.actuator_biasprm[a].any()  # a plain motor: force is gain times control
    if direct and model.actuator_ctrllimited[a]:
        return (
            gear * abs(float(model.actuator_gainprm[a, 0])) * float(np.abs(model.actuator_ctrlrange[a]).min())
        )
    return np.inf


def _joint(model: mujoco.MjModel, joint: int) -> float:
    limited = model.jnt_actfrclimited[joint]
    return float(np.abs(model.jnt_actfrcrange[joint]).min()) if limited else np.inf
