"""A painting posture for an arm whose file gives none: the brush before a wall, with room to move about."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from jaxpaint.compiling import batched
from jaxpaint.errors import InputError
from jaxpaint.kinematics import (
    KinematicChain,
    Pose,
    Spheres,
    arm_chain,
    frame_from_axis,
    jacobian,
    manipulability,
    solve,
    sphere_centers,
    spread_starts,
)

# Where the brush may be at home: this far before the base's front, and this high [m].
_AHEAD, _HEIGHT = np.linspace(0.25, 0.75, 6), 1.1
# Painting goes on around it: to the sides, up and down, and nearer or farther where the base is [m].
_BOX = np.array(
    [[0, y, z] for y in (-0.3, 0.3) for z in (-0.3, 0.0, 0.3)] + [[x, 0, 0] for x in (-0.15, 0.15)]
)
_STARTS, _KEPT = 48, 36  # as many tries in the second round as in the first: one shape to compile
# What the mean over the box counts beside the least: it decides where some of the box is out of reach.
_MEAN = 0.1
# The body stays this far behind the brush's tip, and links this far from what they are not hinged to [m].
_BEHIND, _APART = 0.04, 0.01
# A joint nearer to its limit, and a link nearer to another, than this is worth less [rad, m].
_MARGIN, _ROOM = 0.5, 0.10


class Candidate(NamedTuple):
    """An arm posture and how good it is: 0 for one that does not do."""

    q: Float[Array, " arm"]
    score: Float[Array, ""]


class _Arm(NamedTuple):
    chain: KinematicChain
    spheres: Spheres
    lower: Array
    upper: Array
    near: Array  # which pairs of spheres may touch


def painting_posture(
    chain: KinematicChain, spheres: Spheres, lower: np.ndarray, upper: np.ndarray, front: float
) -> np.ndarray:
    """The arm posture, brush level and ahead, whose surroundings it can paint best.

    chain: with three base joints, held at zero. front: of the base [m]. A posture is worth the least
    manipulability over a box around its brush, where inverse kinematics goes on from it, and a little of the
    mean; 0 where the arm does not get there, or touches itself or the wall. Raises InputError where all are.
    """
    arm = _Arm(chain, spheres, jnp.asarray(lower), jnp.asarray(upper), jnp.asarray(_may_touch(spheres)))
    middle = jnp.asarray(np.clip(0.0, lower, upper))
    starts = np.asarray(spread_starts(middle, arm.lower, arm.upper, count=_STARTS))
    places = np.array([[front + ahead, 0.0, _HEIGHT] for ahead in _AHEAD])
    first = _tried(arm, np.tile(starts, (len(places), 1)), np.repeat(places, len(starts), axis=0))
    best = np.argsort(-first.score, kind="stable")[:_KEPT]
    q = first.q[best]
    box = np.repeat(places, len(starts), axis=0)[best][:, None] + _BOX
    around = _tried(arm, np.repeat(q, len(_BOX), axis=0), box.reshape(-1, 3)).score.reshape(len(best), -1)
    worth = np.where(first.score[best] > 0, around.min(axis=1) + _MEAN * around.mean(axis=1), 0.0)
    if not worth.max() > 0:
        raise InputError(
            "no keyframe named 'home' with the arm's painting posture, and none was found that holds the "
            f"brush level, {_AHEAD[0]} to {_AHEAD[-1]} m ahead of the base and {_HEIGHT} m high"
        )
    return np.asarray(q[int(worth.argmax())])


def _tried(arm: _Arm, start: np.ndarray, place: np.ndarray) -> Candidate:
    return jax.tree.map(np.asarray, _POSTURES(arm, start, place.astype(start.dtype)))


def _posture(arm: _Arm, start: Float[Array, " arm"], place: Float[Array, "3"]) -> Candidate:
    """From one start to one place: manipulability, less near joint limits, 0 where something touches."""
    held = arm_chain(arm.chain, jnp.zeros(3, start.dtype))
    ahead, right = jnp.asarray([1.0, 0, 0], start.dtype), jnp.asarray([0, -1.0, 0], start.dtype)
    found = solve(held, start[None], Pose(place, frame_from_axis(ahead, right)), arm.lower, arm.upper)
    room = jnp.minimum(arm.upper - found.q, found.q - arm.lower).min()
    centers = sphere_centers(arm.chain, arm.spheres, jnp.concatenate([jnp.zeros(3, start.dtype), found.q]))
    radius = arm.spheres.radius
    behind = place[0] - (centers[:, 0] + radius).max()
    distance = jnp.sqrt(((centers[:, None] - centers[None]) ** 2).sum(-1) + 1e-12)
    apart = jnp.where(arm.near, 1.0, distance - radius[:, None] - radius[None]).min()
    measure = manipulability(jacobian(held, found.q)[1])
    measure = measure * jnp.clip(room / _MARGIN, 0.0, 1.0) * jnp.clip(apart / _ROOM, 0.0, 1.0)
    good = found.converged & (behind > _BEHIND) & (apart > _APART)
    return Candidate(found.q, jnp.where(good, measure, 0.0))


_POSTURES = batched(_posture, in_axes=(None, 0, 0))


def _may_touch(spheres: Spheres) -> np.ndarray:
    """Pairs on the same link, on links that a joint joins, or, as in a wrist, with one short link between."""
    frame = np.asarray(spheres.frame)
    return np.abs(frame[:, None] - frame[None]) <= 2
