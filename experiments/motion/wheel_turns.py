"""The least time that a base's wheels need to turn at the corners of its path."""

import mujoco
import numpy as np
from jaxtyping import Bool, Float

# A base that goes less than this stands [m or rad]; a wheel whose contact hardly moves keeps its direction.
_STILL, _HARDLY = 1e-6, 1e-4


def wheel_turns(
    model: mujoco.MjModel,
    points: Float[np.ndarray, "w 3"],
    duration: Float[np.ndarray, " segments"],
    corner: Bool[np.ndarray, " w"],
) -> float:
    """Sum over the corners [s]: a steered wheel that does not slip points along its way. Where the way of a
    base breaks off it must turn while the base stands, by a quarter turn at most, at its rate limit.

    points: poses (x, y, yaw) of the base. corner: where the mission itself asks for no rest. duration: of the
    segments; while the arm alone moves the wheels can turn as well.
    """
    steer = [k for k in range(model.njnt) if model.joint(k).name.startswith("steer_")]
    place = np.array([model.body(model.jnt_bodyid[k]).pos[:2] for k in steer])
    rates = [model.actuator(model.joint(k).name).ctrlrange[1] for k in steer]
    total, still, before = 0.0, np.inf, None
    for k, way in enumerate(np.diff(points, axis=0)):
        still = still if corner[k] else np.inf
        if np.abs(way).max() < _STILL or duration[k] <= 0:
            still += duration[k]
            continue
        begins, ends = (_contacts(place, way, points[n, 2]) for n in (k, k + 1))
        if before is not None:
            total += max(0.0, float((_turn(before, begins) / rates).max()) - still)
        before, still = ends, 0.0
    return total


def _contacts(place, way, yaw: float) -> Float[np.ndarray, "wheels 2"]:
    """Direction in which each wheel's contact moves, in the base's frame."""
    c, s = np.cos(yaw), np.sin(yaw)
    x, y = c * way[0] + s * way[1], c * way[1] - s * way[0]
    speed = np.stack([x - way[2] * place[:, 1], y + way[2] * place[:, 0]], -1)
    return speed / np.linalg.norm(way)


def _turn(one, other) -> Float[np.ndarray, " wheels"]:
    """Angle between two directions of a wheel, which may roll either way [rad]."""
    angle = np.arctan2(other[:, 1], other[:, 0]) - np.arctan2(one[:, 1], one[:, 0])
    moves = np.minimum(np.linalg.norm(one, axis=1), np.linalg.norm(other, axis=1)) > _HARDLY
    return np.where(moves, np.abs((angle + np.pi / 2) % np.pi - np.pi / 2), 0)
