"""Reads a robot from its MJCF file."""

from collections.abc import Sequence
from pathlib import Path

import jax.numpy as jnp
import mujoco
import numpy as np

from jaxpaint.errors import InputError
from jaxpaint.kinematics import KinematicChain, Pose
from sims.robots.body import footprint_from_model, spheres_from_model
from sims.robots.model import body_frames, chain_from_model, find, joints_to, matrix
from sims.robots.robot import Robot, Wheels

REFERENCE = Path(__file__).with_name("reference.xml")

BASE_JOINTS = ("base_x", "base_y", "base_yaw")
CORNERS = ("fl", "fr", "rl", "rr")

# For an MJCF that does not say: no actuator on a joint, no numeric, no wheels.
_BASE_SPEED, _ARM_SPEED = (0.5, 0.5, 1.0), np.pi
_BASE_ACCELERATION, _ARM_ACCELERATION = (0.5, 0.5, 1.0), 8.0
_WHEEL_RADIUS, _STEER_SPEED, _DRIVE_SPEED = 0.1, 3.0, 12.0


def robot_model(path: Path | str | None = None) -> mujoco.MjModel:
    """The compiled model of an MJCF file, by default the reference robot's."""
    path = REFERENCE if path is None else Path(path)
    if not path.is_file():
        raise InputError(f"robot {path}: no such file; expected an MJCF (.xml)")
    try:
        return mujoco.MjModel.from_xml_path(str(path))
    except ValueError as error:
        first = str(error).strip().splitlines()[0]
        raise InputError(f"robot {path}: not an MJCF that MuJoCo compiles: {first}") from error


def load_robot(path: Path | str | None = None) -> Robot:
    """The robot of an MJCF file, by default the reference robot.

    The file has slides `base_x`, `base_y` and a hinge `base_yaw` at the root, in this order, an arm of hinges
    behind them that carries the sites `brush` (z out of the tool) and `camera` (OpenCV axes), and a keyframe
    `home`. Speed limits are the control ranges of velocity actuators; accelerations the numerics
    `base_acceleration` and `arm_acceleration`. Optional, else as the reference robot's: joints `steer_fl`,
    `wheel_fl`, and so on; else at the base's origin: site `lidar`.
    """
    model = robot_model(path)
    try:
        return robot_from_model(model)
    except InputError as error:
        raise InputError(f"robot {REFERENCE.name if path is None else path}: {error}") from error


def robot_from_model(model: mujoco.MjModel) -> Robot:
    """The robot of a compiled model: see `load_robot`."""
    for name in BASE_JOINTS:
        find(model, mujoco.mjtObj.mjOBJ_JOINT, name)
    brush = find(model, mujoco.mjtObj.mjOBJ_SITE, "brush")
    joints = joints_to(model, int(model.site_bodyid[brush]))
    chain = chain_from_model(model, "brush")
    _check(model, chain)
    arm = joints[len(BASE_JOINTS) :]
    lower, upper = _limits(model, arm)
    return Robot(
        chain=chain,
        home=jnp.asarray(_home(model, arm)),
        lower=jnp.asarray(lower),
        upper=jnp.asarray(upper),
        speed_limit=jnp.asarray(_speed_limits(model, joints)),
        acceleration_limit=jnp.asarray(_acceleration_limits(model, len(arm))),
        T_brush_camera=_between_sites(model, "brush", "camera"),
        T_base_lidar=_lidar(model, joints),
        wheels=_wheels(model),
        footprint=jnp.asarray(footprint_from_model(model, joints, len(BASE_JOINTS))),
        spheres=spheres_from_model(model, joints),
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
    find(model, mujoco.mjtObj.mjOBJ_SITE, "camera")


def _limits(model: mujoco.MjModel, joints: Sequence[int]) -> tuple[np.ndarray, np.ndarray]:
    limited = model.jnt_limited[joints].astype(bool)[:, None]
    free = np.array([-2 * np.pi, 2 * np.pi])
    ranges = np.where(limited, model.jnt_range[joints], free)
    return ranges[:, 0], ranges[:, 1]


def _home(model: mujoco.MjModel, joints: Sequence[int]) -> np.ndarray:
    key = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_KEY, "home")
    if key < 0:
        raise InputError("no keyframe named 'home'; it gives the arm's painting posture")
    return model.key_qpos[key][model.jnt_qposadr[joints]]


def _speed_limits(model: mujoco.MjModel, joints: Sequence[int]) -> np.ndarray:
    defaults = [*_BASE_SPEED, *[_ARM_SPEED] * (len(joints) - 3)]
    return np.array([_control_range(model, j, default) for j, default in zip(joints, defaults, strict=True)])


def _control_range(model: mujoco.MjModel, joint: int, default: float) -> float:
    """The speed that the velocity servo of a joint can be told [rad/s or m/s]."""
    for a in range(model.nu):
        drives_joint = model.actuator_trntype[a] == int(mujoco.mjtTrn.mjTRN_JOINT)
        # a servo's bias is -gain times what it follows: (offset, position, velocity)
        follows_speed = model.actuator_biasprm[a, 1] == 0 and model.actuator_biasprm[a, 2] < 0
        if (
            drives_joint
            and model.actuator_trnid[a, 0] == joint
            and follows_speed
            and model.actuator_ctrllimited[a]
        ):
            return float(np.abs(model.actuator_ctrlrange[a]).min())
    return default


def _acceleration_limits(model: mujoco.MjModel, arm_size: int) -> np.ndarray:
    base = _numeric(model, "base_acceleration", np.array(_BASE_ACCELERATION))
    arm = _numeric(model, "arm_acceleration", np.full(arm_size, _ARM_ACCELERATION))
    return np.concatenate([base, arm])


def _numeric(model: mujoco.MjModel, name: str, default: np.ndarray) -> np.ndarray:
    index = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_NUMERIC, name)
    if index < 0:
        return default
    found = model.numeric(name).data
    if found.shape != default.shape or not (found > 0).all():
        raise InputError(f"numeric '{name}' is {found.tolist()}; allowed: {len(default)} positive numbers")
    return found


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
    base = body_frames(model)[model.jnt_bodyid[joints[2]]]
    if mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, "lidar") < 0:
        return _pose(np.eye(4))
    return _pose(np.linalg.inv(base) @ _site_frame(model, "lidar"))


def _wheels(model: mujoco.MjModel) -> Wheels:
    """The steered wheels where the file has them, else those of the reference robot."""
    ids = [mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, f"steer_{c}") for c in CORNERS]
    if min(ids) < 0:
        return _wheels(robot_model())
    drives = [find(model, mujoco.mjtObj.mjOBJ_JOINT, f"wheel_{c}") for c in CORNERS]
    base = model.jnt_bodyid[find(model, mujoco.mjtObj.mjOBJ_JOINT, "base_yaw")]
    frames = body_frames(model)
    centers = [(np.linalg.inv(frames[base]) @ frames[model.jnt_bodyid[j]])[:2, 3] for j in ids]
    return Wheels(
        position=jnp.asarray(np.stack(centers)),
        radius=jnp.asarray(np.array(_wheel_radius(model, drives[0]))),
        steer_speed=jnp.asarray(np.array(_control_range(model, ids[0], _STEER_SPEED))),
        drive_speed=jnp.asarray(np.array(_control_range(model, drives[0], _DRIVE_SPEED))),
    )


def _wheel_radius(model: mujoco.MjModel, drive: int) -> float:
    body = model.jnt_bodyid[drive]
    geoms = range(model.body_geomadr[body], model.body_geomadr[body] + model.body_geomnum[body])
    return float(max((model.geom_size[g, 0] for g in geoms), default=_WHEEL_RADIUS))
