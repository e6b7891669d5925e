"""Bodies of a bare model, made of what the joints of another one carry."""

from collections.abc import Sequence

import mujoco
import numpy as np

# Share of a moment of inertia that is rounding.
_ROUNDING = 1e-9

# Mass [kg], center [m] and tensor about it [kg m^2], in the frame of the joint that carries them.
Carried = tuple[float, np.ndarray, np.ndarray]


def add_links(
    parent,
    T_world_parent: np.ndarray,
    model: mujoco.MjModel,
    joints: Sequence[int],
    frames: Sequence[np.ndarray],
    carried: Sequence[Carried],
) -> mujoco.MjsBody:
    """Hangs a chain of joints of `model` to the body `parent`; gives the last of the bodies made.

    frames: T_world_joint. Joints with nothing between them share a body, whose frame is that of the last.
    """
    for first, last in groups(carried):
        parent = add_link(parent, np.linalg.inv(T_world_parent) @ frames[last], *carried[last])
        for k in range(first, last + 1):
            _add_joint(parent, model, joints[k], np.linalg.inv(frames[last]) @ frames[k])
        T_world_parent = frames[last]
    return parent


def groups(carried: Sequence[Carried]) -> list[tuple[int, int]]:
    """First and last joint of each link, by their places: joints with nothing between share one."""
    groups, first = [], 0
    for k, (mass, _, _) in enumerate(carried):
        if mass > 0 or k == len(carried) - 1:
            groups.append((first, k))
            first = k + 1
    return groups


def add_link(parent, T_parent: np.ndarray, mass: float, center: np.ndarray, tensor: np.ndarray):
    """A body without joints at T_parent_body."""
    moments, axes = _principal(tensor)
    return parent.add_body(
        pos=T_parent[:3, 3],
        quat=quaternion(T_parent[:3, :3]),
        mass=mass,
        ipos=center,
        iquat=quaternion(axes),
        inertia=moments,
        explicitinertial=True,
    )


def _principal(tensor: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Principal moments, falling, and their axes as columns of a rotation.

    Of a flat body the largest is the sum of the others; rounding may lift it above, which MuJoCo refuses.
    """
    moments, axes = np.linalg.eigh(tensor)
    moments, axes = moments[::-1].copy(), axes[:, ::-1]
    excess = moments[0] - moments[1] - moments[2]
    if 0 < excess <= _ROUNDING * moments[0]:
        moments[0] = moments[1] + moments[2]
    return moments, axes * np.sign(np.linalg.det(axes))


def quaternion(R: np.ndarray) -> np.ndarray:
    """(w, x, y, z) of a rotation matrix."""
    quat = np.zeros(4)
    mujoco.mju_mat2Quat(quat, R.reshape(-1))
    return quat


def _add_joint(body, model: mujoco.MjModel, joint: int, T_body_joint: np.ndarray) -> None:
    dof = int(model.jnt_dofadr[joint])
    body.add_joint(
        name=model.joint(joint).name,
        type=mujoco.mjtJoint(int(model.jnt_type[joint])),
        pos=T_body_joint[:3, 3],
        axis=T_body_joint[:3, 2],
        armature=model.dof_armature[dof],
        damping=model.dof_damping[dof],
    )
