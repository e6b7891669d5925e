"""The base's drive, found by the names of a model's joints."""

import jax
import jax.numpy as jnp
import mujoco
import numpy as np

from jaxpaint.errors import InputError
from jaxpaint.steering import (
    AbstractDrive,
    CasterWheels,
    DifferentialWheels,
    SteeredWheels,
    holonomic,
    mecanum,
)
from sims.robots.model import body_frames, find, link_frames, names_of, numeric
from sims.robots.servos import speed_of

STEER, WHEEL, ROLLER_ANGLE = "steer_", "wheel_", "roller_angle"

# For a model that does not say.
_STEER_SPEED, _DRIVE_SPEED, _WHEEL_RADIUS, _ROLLER = 3.0, 12.0, 0.1, np.pi / 4
# A base whose wheels are not known has them this far aside [m]; they never hold it back [m/s, rad/s].
_HALF, _NO_LIMIT = 0.25, 1000.0
# Wheels nearer to one line than this make no twist in the plane [m].
_LEAST_SPREAD = 0.02
# A wheel's centre nearer to its steering axis than this lies on it, and offsets that differ less are one [m].
_LEAST_OFFSET = 0.005
# Cosine of the angle between what must be level, or straight ahead, and what is.
_STRAIGHT = np.cos(np.radians(5))


def drive_from_model(model: mujoco.MjModel) -> AbstractDrive:
    """How the base of a model rolls.

    Joints `steer_NAME` and `wheel_NAME` in pairs: steered wheels, casters where the wheels' centres lie ahead
    of their steering axes or behind. Joints `wheel_NAME` alone, which roll along the base's x axis: on one
    axle a differential base, else mecanum wheels with the numeric `roller_angle` [rad] (default: 45 degrees).
    None of them: a holonomic base, of which the speed limits of the planar joints say all. Joints of other
    names, as those of passive casters, count for nothing.
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
            f"wheel (steered), {WHEEL}NAME alone for all (mecanum, differential), or neither (holonomic)"
        )
    drives = [find(model, mujoco.mjtObj.mjOBJ_JOINT, WHEEL + name) for name in wheels]
    rim = min(speed_of(model, j, _DRIVE_SPEED) * _radius(model, j) for j in drives)
    if not steers:
        one_axle = np.ptp(_positions(model, drives)[:, 0]) < _LEAST_SPREAD
        return (_differential if one_axle else _mecanum)(model, drives, rim)
    axes = [find(model, mujoco.mjtObj.mjOBJ_JOINT, STEER + name) for name in wheels]
    position = _positions(model, axes)
    if np.linalg.norm(position - position.mean(0), axis=1).max() < _LEAST_SPREAD:
        raise InputError(f"the {len(axes)} steered wheels stand on one spot; allowed: two or more, apart")
    rate = min(speed_of(model, j, _STEER_SPEED) for j in axes)
    offset = _offset(model, axes, drives)
    if offset == 0:
        return SteeredWheels(_leaf(position), _leaf(rate), _leaf(rim))
    return CasterWheels(_leaf(position), _leaf(offset), _leaf(rate), _leaf(rim))


def _offset(model: mujoco.MjModel, axes: list[int], drives: list[int]) -> float:
    """How far the wheels' centres lie before their steering axes, along the way that they roll [m]."""
    arms = _positions(model, drives) - _positions(model, axes)
    ahead = np.stack([_rolling(model, j) for j in drives])
    along = (arms * ahead).sum(1)
    aside = ahead[:, 0] * arms[:, 1] - ahead[:, 1] * arms[:, 0]
    off = int(np.abs(aside).argmax())
    if abs(aside[off]) >= _LEAST_OFFSET:
        raise InputError(
            f"joint '{model.joint(drives[off]).name}' is {abs(aside[off]):.3f} m beside its steering axis; "
            f"allowed: less than {_LEAST_OFFSET} m, since an offset is along the way that the wheel rolls"
        )
    if np.ptp(along) >= _LEAST_OFFSET:
        raise InputError(
            f"steered wheels with their centres {along.round(3).tolist()} m before their steering axes; "
            "allowed: one offset for all"
        )
    return 0.0 if abs(along.mean()) < _LEAST_OFFSET else float(along.mean())


def _differential(model: mujoco.MjModel, drives: list[int], rim: float) -> AbstractDrive:
    position = _positions(model, drives)
    if np.ptp(position[:, 1]) < _LEAST_SPREAD:
        raise InputError(
            f"wheels that do not steer at {position.round(3).tolist()} m; allowed: two or more on one axle "
            "(differential), or one in each corner (mecanum)"
        )
    for j in drives:
        if _rolling(model, j)[0] < _STRAIGHT:
            raise InputError(
                f"joint '{model.joint(j).name}' of a differential base lets its wheel roll along "
                f"{_rolling(model, j).round(2).tolist()}; allowed: along the base's x axis"
            )
    return DifferentialWheels(_leaf(position[:, 0].mean()), _leaf(position[:, 1]), _leaf(rim))


def _mecanum(model: mujoco.MjModel, drives: list[int], rim: float) -> AbstractDrive:
    position = _positions(model, drives)
    angle = float(numeric(model, ROLLER_ANGLE, np.array([_ROLLER]))[0])
    if (np.abs(position).min(axis=0) < _LEAST_SPREAD).any() or not 0 < angle < np.pi / 2:
        raise InputError(
            f"mecanum wheels at {position.round(3).tolist()} m with rollers at {angle:g} rad; allowed: "
            "wheels off both axes of the base, an angle between 0 and pi/2; or all wheels on one axle "
            f"(differential), with other names than {WHEEL}NAME for casters"
        )
    drive = mecanum(_leaf(position), _leaf(angle), _leaf(rim))
    if np.linalg.matrix_rank(np.asarray(drive.rows, float), tol=_LEAST_SPREAD) < 3:
        raise InputError(
            f"mecanum wheels at {position.round(3).tolist()} m cannot make every twist; allowed: one "
            "in each corner, or all on one axle (differential)"
        )
    return drive


def _leaf(value: float | np.ndarray) -> jax.Array:
    return jnp.asarray(np.asarray(value, float))  # a Python number would be weakly typed


def _positions(model: mujoco.MjModel, joints: list[int]) -> np.ndarray:
    """Where the joints are in the base frame, all of them at 0. [joints, 2], m."""
    return np.stack([T[:2, 3] for T in _in_base(model, joints)])


def _rolling(model: mujoco.MjModel, drive: int) -> np.ndarray:
    """The way in which a wheel rolls in the base frame, of both the one more ahead. [2], of length 1."""
    axle = _in_base(model, [drive])[0][:2, 2]
    if np.linalg.norm(axle) < _STRAIGHT:
        raise InputError(f"the axis of joint '{model.joint(drive).name}' is not level; a wheel's is")
    ahead = np.array([axle[1], -axle[0]]) / np.linalg.norm(axle)
    return ahead if ahead[0] + _LEAST_OFFSET * ahead[1] > 0 else -ahead  # to the left, where neither is


def _in_base(model: mujoco.MjModel, joints: list[int]) -> list[np.ndarray]:
    """T_base_joint of each joint, its z along the axis. 4x4."""
    base = model.jnt_bodyid[find(model, mujoco.mjtObj.mjOBJ_JOINT, "base_yaw")]
    to_base = np.linalg.inv(body_frames(model)[base])
    return [to_base @ T for T in link_frames(model, joints)]


def _radius(model: mujoco.MjModel, drive: int) -> float:
    """Of the largest geom on the wheel's body [m]; a mesh's is the middle of its three half sizes."""
    body = model.jnt_bodyid[drive]
    found = []
    for g in range(model.body_geomadr[body], model.body_geomadr[body] + model.body_geomnum[body]):
        mesh = model.geom_type[g] == int(mujoco.mjtGeom.mjGEOM_MESH)
        found.append(np.sort(model.geom_aabb[g, 3:])[1] if mesh else model.geom_size[g, 0])
    return float(max(found, default=_WHEEL_RADIUS))
