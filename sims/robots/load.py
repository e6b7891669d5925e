"""Reads a robot from its file."""

from collections.abc import Sequence
from pathlib import Path

import jax.numpy as jnp
import mujoco
import numpy as np

from jaxpaint.errors import InputError
from jaxpaint.kinematics import KinematicChain, Pose, frames
from sims.robots.body import base_top, footprint_from_model, spheres_from_model
from sims.robots.home import painting_posture
from sims.robots.inertia import inertia_from_model, torque_limits, weight_at
from sims.robots.model import body_frames, chain_from_model, find, floor_frame, joints_to, matrix, numeric
from sims.robots.read import BRUSH, CAMERA, LIDAR, REFERENCE, robot_model
from sims.robots.robot import Robot
from sims.robots.servos import speed_of
from sims.robots.urdf import BASE_JOINTS
from sims.robots.wheels import drive_from_model

# For a file that does not say: no actuator on a joint, no numeric.
_BASE_SPEED, _ARM_SPEED = (0.5, 0.5, 1.0), np.pi
_BASE_ACCELERATION, _ARM_ACCELERATION = (0.5, 0.5, 1.0), 8.0
# Arms of fewer joints hold a brush in few postures only: none is searched.
_LEAST_SEARCHED = 6
# A joint without a range may go this far either way [rad or m]: a number, so that no gradient is NaN.
_NO_LIMIT = 100.0


def load_robot(
    path: Path | str | None = None, *, brush_site: str = BRUSH, camera_site: str = CAMERA
) -> Robot:
    """The robot of an MJCF or URDF file, by default the reference robot. At length: docs/robots.md.

    Joints: slides `base_x`, `base_y` and a hinge `base_yaw` at the root, in this order (a URDF gets them),
    then the arm's, of which any number. Sites, or links, of these names or of those given: `brush` (z out of
    the tool), `camera` on the same link (OpenCV axes); `lidar`, else on top of the base. Wheels: joints
    `steer_NAME` and `wheel_NAME` in pairs are steered, with an offset casters, `wheel_NAME` alone mecanum
    (numeric `roller_angle`) or on one axle differential, none make a holonomic base. Speed limits are the
    control ranges of velocity actuators, or a URDF's; accelerations the numerics `base_acceleration` and
    `arm_acceleration`. The keyframe `home` is the painting posture, else one is searched. Raises InputError.
    """
    model = robot_model(path, brush_site=brush_site, camera_site=camera_site)
    try:
        return robot_from_model(model)
    except InputError as error:
        raise InputError(f"robot {REFERENCE.name if path is None else path}: {error}") from error


def robot_from_model(model: mujoco.MjModel) -> Robot:
    """The robot of a compiled model: see `load_robot`."""
    for name in BASE_JOINTS:
        find(model, mujoco.mjtObj.mjOBJ_JOINT, name)
    brush = find(model, mujoco.mjtObj.mjOBJ_SITE, BRUSH)
    joints = joints_to(model, int(model.site_bodyid[brush]))
    chain = chain_from_model(model, BRUSH)
    _check(model, chain)
    arm = joints[len(BASE_JOINTS) :]
    lower, upper = _limits(model, arm)
    spheres = spheres_from_model(model, joints)
    footprint = footprint_from_model(model, joints, len(BASE_JOINTS))
    home = _home(model, arm)
    if home is None and len(arm) < _LEAST_SEARCHED:
        raise InputError("no keyframe named 'home'; it gives the arm's painting posture")
    if home is None:
        home = painting_posture(chain, spheres, lower, upper, float(footprint[:, 0].max()))
    _check_weight(model, arm, home)
    return Robot(
        chain=chain,
        home=jnp.asarray(home),
        lower=jnp.asarray(lower),
        upper=jnp.asarray(upper),
        speed_limit=jnp.asarray(_speed_limits(model, joints)),
        acceleration_limit=jnp.asarray(_acceleration_limits(model, len(arm))),
        T_brush_camera=_between_sites(model, BRUSH, CAMERA),
        T_base_lidar=_lidar(model, joints),
        drive=drive_from_model(model),
        footprint=jnp.asarray(footprint),
        spheres=spheres,
        brush=spheres_from_model(model, joints, brush=True),
        inertia=inertia_from_model(model, joints),
        torque_limit=jnp.asarray(torque_limits(model, joints)),
    )


def _check(model: mujoco.MjModel, chain: KinematicChain) -> None:
    if chain.names[:3] != BASE_JOINTS or len(chain.names) == 3:
        raise InputError(
            f"the way to site 'brush' has joints {', '.join(chain.names)}; it must begin with "
            f"{', '.join(BASE_JOINTS)} and go on with the arm's"
        )
    if chain.kinds[:3] != ("slide", "slide", "hinge"):
        raise InputError(
            f"{', '.join(BASE_JOINTS)} are {', '.join(chain.kinds[:3])}; allowed: slide, slide, hinge"
        )
    _check_base_axes(chain)
    find(model, mujoco.mjtObj.mjOBJ_SITE, CAMERA)


def _check_base_axes(chain: KinematicChain) -> None:
    """The base's joints act along x, along y and about z of the map."""
    axes = np.asarray(frames(chain, jnp.zeros(chain.size)).R)[:3, :, 2]
    if np.abs(axes - np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1]])).max() > 1e-4:
        raise InputError(
            f"{', '.join(BASE_JOINTS)} act along {axes.round(3).tolist()}; allowed: x, y and z of the world"
        )


def _limits(model: mujoco.MjModel, joints: Sequence[int]) -> tuple[np.ndarray, np.ndarray]:
    limited = model.jnt_limited[joints].astype(bool)[:, None]
    ranges = np.where(limited, model.jnt_range[joints], np.array([-_NO_LIMIT, _NO_LIMIT]))
    return ranges[:, 0], ranges[:, 1]


def _home(model: mujoco.MjModel, joints: Sequence[int]) -> np.ndarray | None:
    """The arm's part of the keyframe `home`, None where there is none."""
    key = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_KEY, "home")
    return None if key < 0 else model.key_qpos[key][model.jnt_qposadr[joints]]


def _check_weight(model: mujoco.MjModel, arm: Sequence[int], home: np.ndarray) -> None:
    """The motors must hold the arm still at home: no plan could begin there."""
    limits = torque_limits(model, arm)
    for j, torque, limit in zip(arm, weight_at(model, arm, home), limits, strict=True):
        if not abs(torque) <= limit:
            unit = "N m" if int(model.jnt_type[j]) == int(mujoco.mjtJoint.mjJNT_HINGE) else "N"
            raise InputError(
                f"at home the weight on joint '{model.joint(j).name}' asks for {abs(torque):.3g} {unit}; "
                f"allowed: its limit of {limit:g} {unit}, or less"
            )


def _speed_limits(model: mujoco.MjModel, joints: Sequence[int]) -> np.ndarray:
    defaults = [*_BASE_SPEED, *[_ARM_SPEED] * (len(joints) - 3)]
    return np.array([speed_of(model, j, default) for j, default in zip(joints, defaults, strict=True)])


def _acceleration_limits(model: mujoco.MjModel, arm_size: int) -> np.ndarray:
    base = numeric(model, "base_acceleration", np.array(_BASE_ACCELERATION))
    arm = numeric(model, "arm_acceleration", np.full(arm_size, _ARM_ACCELERATION))
    return np.concatenate([base, arm])


def _site_frame(model: mujoco.MjModel, name: str) -> np.ndarray:
    site = find(model, mujoco.mjtObj.mjOBJ_SITE, name)
    return body_frames(model)[model.site_bodyid[site]] @ matrix(model.site_pos[site], model.site_quat[site])


def _pose(T: np.ndarray) -> Pose:
    return Pose(jnp.asarray(T[:3, 3]), jnp.asarray(T[:3, :3]))


def _between_sites(model: mujoco.MjModel, a: str, b: str) -> Pose:
    bodies = [model.site_bodyid[find(model, mujoco.mjtObj.mjOBJ_SITE, name)] for name in (a, b)]
    if joints_to(model, int(bodies[0])) != joints_to(model, int(bodies[1])):
        raise InputError(f"sites '{a}' and '{b}' must ride on the same link")
    return _pose(np.linalg.inv(_site_frame(model, a)) @ _site_frame(model, b))


def _lidar(model: mujoco.MjModel, joints: Sequence[int]) -> Pose:
    """Where the lidar is on the base, else the base's top: up to there the footprint counts as the body."""
    if mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, LIDAR) < 0:
        top = base_top(model, joints, len(BASE_JOINTS))
        return _pose(matrix(np.array([0, 0, top]), np.array([1.0, 0, 0, 0])))
    return _pose(np.linalg.inv(floor_frame(model, joints[2])) @ _site_frame(model, LIDAR))
