"""How long a robot waits at via points: until its wheels point to where it goes next."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from jaxpaint.compiling import batched
from jaxpaint.steering import Stance
from sims.robots import Robot

# Beside what the wheels need: two control periods, since the drive turns in steps [s].
_SPARE = 0.04
# Times that are tried for the wheels, as shares of the longest rest; an angle that is right to this is right
# [rad]; a base that goes less than this stands [m or rad].
_TRIED, _RIGHT, _STILL = 31, 0.01, 1e-6


def via_rests(
    robot: Robot,
    points: Float[np.ndarray, "worlds w joints"],
    duration: Float[np.ndarray, "worlds segments"],
    parts: int,
    longest: float,
) -> Float[np.ndarray, "worlds w"]:
    """Rest at each point [s]: `longest` at every `parts`-th, which is no via point; at the others what the
    wheels need beyond the time that the base has stood still already, nothing where it does not set off.

    duration: of the segments between the points [s].
    """
    way = np.diff(points[:, :, :3], axis=1)
    moves = (np.abs(way) > _STILL).any(-1) & (duration > 0)
    rest = np.zeros(points.shape[:2])
    needed = _needed(robot, points, way, moves, longest)
    still = np.full(len(points), np.inf)
    for k in range(way.shape[1]):
        rest[:, k] = np.where(moves[:, k], np.clip(needed[:, k] - still, 0, longest), 0)
        rest[:, k] = rest[:, k] if k % parts else longest
        still = np.where(moves[:, k], 0, still + rest[:, k] + duration[:, k])
    rest[:, -1] = longest
    return rest


def _needed(robot: Robot, points, way, moves, longest: float) -> Float[np.ndarray, "worlds segments"]:
    """Time for the wheels to turn from the base's last way to each [s]."""
    worlds, segments, _ = way.shape
    ended, last = np.zeros((worlds, segments, 3)), np.zeros((worlds, 3))
    for k in range(segments):
        ended[:, k] = last
        last = np.where(moves[:, k, None], _in_base(way[:, k], points[:, k + 1, 2]), last)
    begun = _in_base(way, points[:, :-1, 2])
    pairs = np.stack([ended, begun], axis=2).reshape(-1, 2, 3).astype(np.float32)
    time = np.asarray(_TURNING(robot, pairs, np.full(len(pairs), longest, np.float32)))
    known = np.abs(ended).max(-1) > 0
    return np.where(known, time.reshape(worlds, segments) + _SPARE, 0)


def _in_base(way: Float[np.ndarray, "*n 3"], yaw: Float[np.ndarray, "*n"]) -> Float[np.ndarray, "*n 3"]:
    """The direction of a way as a twist of the base, of unit size."""
    c, s = np.cos(yaw), np.sin(yaw)
    twist = np.stack(
        [c * way[..., 0] + s * way[..., 1], c * way[..., 1] - s * way[..., 0], way[..., 2]], axis=-1
    )
    return twist / np.maximum(np.linalg.norm(twist, axis=-1, keepdims=True), 1e-9)


def _turning(robot: Robot, twists: Float[Array, "2 3"], longest: Float[Array, ""]) -> Float[Array, ""]:
    """The least of the tried times after which the wheels fit the second twist, where they fit the first."""
    drive, soon, late = robot.drive, jnp.linspace(0, 1, _TRIED) * longest, 100 * longest
    still = jnp.zeros(drive.size)

    def turned(twist, stance, time):
        return drive.step(jnp.zeros(3), twist, stance, time).stance

    before = turned(twists[0], Stance(still, still), late)
    after = turned(twists[1], before, late)

    def off(time):
        return jnp.abs(turned(twists[1], before, time).angle - after.angle).max(initial=0.0)

    right = jax.vmap(off)(soon) <= _RIGHT
    return jnp.where(right, soon, longest).min()


_TURNING = batched(_turning, in_axes=(None, 0, 0))
