"""The kinematic chain of a compiled MuJoCo model."""

from collections.abc import Sequence

import jax.numpy as jnp
import mujoco
import numpy as np

from jaxpaint.errors import InputError
from jaxpaint.kinematics import KinematicChain

_KINDS = {int(mujoco.mjtJoint.mjJNT_HINGE): "hinge", int(mujoco.mjtJoint.mjJNT_SLIDE): "slide"}


def chain_from_model(model: mujoco.MjModel, site: str, joints: Sequence[str] | None = None) -> KinematicChain:
    """The chain from the world to `site`, whose joints are `joints`, root first (default: all on the way).

    A joint that is on the way but not among `joints`, or the other way round, is an InputError.
    """
    site_id = find(model, mujoco.mjtObj.mjOBJ_SITE, site)
    on_the_way = joints_to(model, int(model.site_bodyid[site_id]))
    names = [model.joint(j).name for j in on_the_way]
    if not names:
        raise InputError(f"site '{site}' is fixed to the world; allowed: on the arm's last link")
    if joints is not None and list(joints) != names:
        raise InputError(f"joints to site '{site}': found {list(joints)}, the model has {names}")
    links = link_frames(model, on_the_way)
    offsets = [_inverse(a) @ b for a, b in zip([np.eye(4), *links], links, strict=False)]
    T_body_site = matrix(model.site_pos[site_id], model.site_quat[site_id])
    tool = _inverse(links[-1]) @ body_frames(model)[model.site_bodyid[site_id]] @ T_body_site
    return KinematicChain(
        R_offset=jnp.asarray(np.stack([T[:3, :3] for T in offsets])),
        p_offset=jnp.asarray(np.stack([T[:3, 3] for T in offsets])),
        R_tool=jnp.asarray(tool[:3, :3]),
        p_tool=jnp.asarray(tool[:3, 3]),
        kinds=tuple(_KINDS[int(model.jnt_type[j])] for j in on_the_way),
        names=tuple(names),
    )


def find(model: mujoco.MjModel, kind: mujoco.mjtObj, name: str) -> int:
    """The index of a named object; its absence is an InputError with the names there are."""
    index = mujoco.mj_name2id(model, kind, name)
    if index < 0:
        what = kind.name.removeprefix("mjOBJ_").lower()
        raise InputError(
            f"no {what} named '{name}', the model has {', '.join(names_of(model, kind)) or 'none'}"
        )
    return index


def numeric(model: mujoco.MjModel, name: str, default: np.ndarray) -> np.ndarray:
    """The positive numbers of a custom numeric, as many as the default has, which stands in where none is."""
    index = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_NUMERIC, name)
    if index < 0:
        return default
    found = model.numeric(name).data
    if found.shape != default.shape or not ((found > 0) & (found < np.inf)).all():
        raise InputError(f"numeric '{name}' is {found.tolist()}; allowed: {len(default)} positive numbers")
    return found


def names_of(model: mujoco.MjModel, kind: mujoco.mjtObj) -> list[str]:
    """The names of all objects of a kind."""
    count = {mujoco.mjtObj.mjOBJ_SITE: model.nsite, mujoco.mjtObj.mjOBJ_JOINT: model.njnt}[kind]
    return [name for i in range(count) if (name := mujoco.mj_id2name(model, kind, i))]


def joints_to(model: mujoco.MjModel, body: int) -> list[int]:
    """The joints between the world and a body, root first."""
    found: list[int] = []
    while body > 0:
        first, count = model.body_jntadr[body], model.body_jntnum[body]
        found = [*range(first, first + count), *found]
        body = model.body_parentid[body]
    for j in found:
        if int(model.jnt_type[j]) not in _KINDS:
            raise InputError(
                f"joint '{model.joint(j).name}' is free or a ball, allowed are hinges and slides"
            )
    return found


def carrier(model: mujoco.MjModel, body: int, joints: Sequence[int]) -> int | None:
    """Which of the joints carries a body, as its place among them; None for what is fixed to the world."""
    while body > 0:
        mine = [k for k, j in enumerate(joints) if model.jnt_bodyid[j] == body]
        if mine:
            return mine[-1]
        body = int(model.body_parentid[body])
    return None


def link_frames(model: mujoco.MjModel, joints: Sequence[int]) -> list[np.ndarray]:
    """T_world_joint of each joint, all of them at 0: origin at its anchor, z along its axis. 4x4, float64."""
    # At 0, and not at the model's reference position: what a joint's `ref` turns is part of the frames.
    data = at_zero(model)
    mujoco.mj_kinematics(model, data)
    frames = []
    for j in joints:
        T = np.eye(4)
        T[:3, :3] = _with_z(data.xaxis[j], data.xmat[model.jnt_bodyid[j]].reshape(3, 3))
        T[:3, 3] = data.xanchor[j]
        frames.append(T)
    return frames


def body_frames(model: mujoco.MjModel) -> np.ndarray:
    """T_world_body of each body with all joints at 0. [bodies, 4, 4], float64."""
    data = at_zero(model)
    mujoco.mj_kinematics(model, data)
    frames = np.tile(np.eye(4), (model.nbody, 1, 1))
    frames[:, :3, :3] = data.xmat.reshape(-1, 3, 3)
    frames[:, :3, 3] = data.xpos
    return frames


def floor_frame(model: mujoco.MjModel, joint: int) -> np.ndarray:
    """T_world_base on the floor, under the body that the base's last joint moves. 4x4, float64."""
    T = body_frames(model)[model.jnt_bodyid[joint]].copy()
    T[2, 3] = 0.0
    return T


def matrix(p: np.ndarray, quat: np.ndarray) -> np.ndarray:
    """The homogeneous matrix of a position and a quaternion (w, x, y, z)."""
    R = np.zeros(9)
    mujoco.mju_quat2Mat(R, quat)
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R.reshape(3, 3), p
    return T


def at_zero(model: mujoco.MjModel) -> mujoco.MjData:
    """Data with all joints at 0, nothing computed yet."""
    data = mujoco.MjData(model)
    data.qpos[:] = 0
    for j in range(model.njnt):
        kind = mujoco.mjtJoint(int(model.jnt_type[j]))
        if kind in (mujoco.mjtJoint.mjJNT_FREE, mujoco.mjtJoint.mjJNT_BALL):
            data.qpos[model.jnt_qposadr[j] + (3 if kind == mujoco.mjtJoint.mjJNT_FREE else 0)] = 1
    return data


def _with_z(axis: np.ndarray, body: np.ndarray) -> np.ndarray:
    """A rotation with z along `axis`: the body's own axes, cycled, where that does; none is rounded then."""
    for k in range(3):
        if np.array_equal(body[:, k], axis):
            return body[:, [(k + 1) % 3, (k + 2) % 3, k]]
    x = np.cross(body[:, np.argmin(np.abs(axis @ body))], axis)
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(axis, x), axis], axis=1)


def _inverse(T: np.ndarray) -> np.ndarray:
    out = np.eye(4)
    out[:3, :3] = T[:3, :3].T
    out[:3, 3] = -T[:3, :3].T @ T[:3, 3]
    return out
