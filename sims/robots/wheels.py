"""The base's drive, found by the names of a model's joints."""

import jax
import jax.numpy as jnp
import mujoco
import numpy as np

from jaxpaint.errors import InputError
from jaxpaint.steering import AbstractDrive, SteeredWheels, holonomic, mecanum
from sims.robots.model import body_frames, find, names_of, numeric
from sims.robots.servos import speed_of

STEER, WHEEL, ROLLER_ANGLE = "steer_", "wheel_", "roller_angle"

# For a model that does not say.
_STEER_SPEED, _DRIVE_SPEED, _WHEEL_RADIUS, _ROLLER = 3.0, 12.0, 0.1, np.pi / 4
# A base whose wheels are not known has them this far aside [m]; they never hold it back [m/s, rad/s].
_HALF, _NO_LIMIT = 0.25, 1000.0
# Wheels nearer to one line than this make no twist in the plane [m].
_LEAST_SPREAD = 0.02


def drive_from_model(model: mujoco.MjModel) -> AbstractDrive:
    """How the base of a model rolls.

    Joints `steer_NAME` and `wheel_NAME` in pairs: steered wheels. Joints `wheel_NAME` alone: mecanum wheels
    that roll along the base's x axis, with the numeric `roller_angle` [rad] (default: 45 degrees). None of
    them: a holonomic base, of which the speed limits of the planar joints say all.
    """
    names = names_of(model, mujoco.mjtObj.mjOBJ_JOINT)
    steers = [name.removeprefix(STEER) for name in names if name.startswith(STEER)]
    wheels = [name.removeprefix(WHEEL) for name in names if name.startswith(WHEEL)]
    if not steers and not wheels:
        return holonomic(_leaf(_HALF), _leaf(_NO_LIMIT), _leaf(_NO_LIMIT))
    if steers and set(steers) != set(wheels):
        odd = ", ".join(sorted(set(steers) ^ set(wheels)))
        raise InputError(
            f"wheels {odd} have only one of the joints {STEER}NAME and {WHEEL}NAME; allowed: both for every "
            f"wheel (steered), {WHEEL}NAME alone for all (mecanum), or neither (holonomic)"
        )
    drives = [find(model, mujoco.mjtObj.mjOBJ_JOINT, WHEEL + name) for name in wheels]
    rim = min(speed_of(model, j, _DRIVE_SPEED) * _radius(model, j) for j in drives)
    if not steers:
        return _mecanum(model, drives, rim)
    axes = [find(model, mujoco.mjtObj.mjOBJ_JOINT, STEER + name) for name in wheels]
    position = _positions(model, axes)
    if np.linalg.norm(position - position.mean(0), axis=1).max() < _LEAST_SPREAD:
        raise InputError(f"the {len(axes)} steered wheels stand on one spot; allowed: two or more, apart")
    rate = min(speed_of(model, j, _STEER_SPEED) for j in axes)
    return SteeredWheels(_leaf(position), _leaf(rate), _leaf(rim))


def _mecanum(model: mujoco.MjModel, drives: list[int], rim: float) -> AbstractDrive:
    position = _positions(model, drives)
    angle = float(numeric(model, ROLLER_ANGLE, np.array([_ROLLER]))[0])
    if len(drives) < 3 or np.ptp(position[:, 0]) < _LEAST_SPREAD:
        raise InputError(
            f"{len(drives)} wheels on one axle that do not steer: a differential base, which cannot go "
            "sideways and is not built yet; allowed: steered wheels, mecanum wheels at the corners, or no "
            "wheel joints"
        )
    if (np.abs(position).min(axis=0) < _LEAST_SPREAD).any() or not 0 < angle < np.pi / 2:
        raise InputError(
            f"mecanum wheels at {position.round(3).tolist()} m with rollers at {angle:g} rad; allowed: "
            "wheels off both axes of the base, an angle between 0 and pi/2"
        )
    drive = mecanum(_leaf(position), _leaf(angle), _leaf(rim))
    if np.linalg.matrix_rank(np.asarray(drive.rows, float), tol=_LEAST_SPREAD) < 3:
        raise InputError(
            f"mecanum wheels at {position.round(3).tolist()} m cannot make every twist; allowed: one "
            "in each corner"
        )
    return drive


def _leaf(value: float | np.ndarray) -> jax.Array:
    return jnp.asarray(np.asarray(value, float))  # a Python number would be weakly typed


def _positions(model: mujoco.MjModel, joints: list[int]) -> np.ndarray:
    """Where the joints' bodies are in the base frame. [joints, 2], m."""
    frames = body_frames(model)
    base = model.jnt_bodyid[find(model, mujoco.mjtObj.mjOBJ_JOINT, "base_yaw")]
    to_base = np.linalg.inv(frames[base])
    return np.stack([(to_base @ frames[model.jnt_bodyid[j]])[:2, 3] for j in joints])


def _radius(model: mujoco.MjModel, drive: int) -> float:
    """Of the largest geom on the wheel's body [m]; a mesh's is the middle of its three half sizes."""
    body = model.jnt_bodyid[drive]
    found = []
    for g in range(model.body_geomadr[body], model.body_geomadr[body] + model.body_geomnum[body]):
        mesh = model.geom_type[g] == int(mujoco.mjtGeom.mjGEOM_MESH)
        found.append(np.sort(model.geom_aabb[g, 3:])[1] if mesh else model.geom_size[g, 0])
    return float(max(found, default=_WHEEL_RADIUS))
