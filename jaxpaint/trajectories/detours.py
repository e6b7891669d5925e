"""Ways around: where the straight motion would touch something, retreat first, go, and approach."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from jaxpaint.kinematics.chain import KinematicChain, arm_chain, forward
from jaxpaint.kinematics.ik import IKSettings, solve, spread_starts
from jaxpaint.kinematics.pose import Pose

_TOOL, _SHARED, _HEADING = range(3)
_KEPT, _FOLDED, _WRIST_FIRST, _WRIST_LAST, _WRIST_HOME, _SPREAD = range(6)
_POSTURES = 12

WAYS = np.array(
    [
        # tool, base, where the base goes, what the arm does
        [0.12, 0.0, _TOOL, 0],
        [0.25, 0.0, _TOOL, 0],
        [0.0, 0.25, _TOOL, 0],
        [0.15, 0.25, _TOOL, 0],
        [0.0, 0.3, _SHARED, 0],
        [0.15, 0.4, _SHARED, 0],
        [0.0, 0.5, _TOOL, 0],
        [0.25, 0.5, _TOOL, 0],
        [0.0, 0.4, _HEADING, 1],
        [0.0, 0.6, _SHARED, 0],
        [0.2, 0.8, _SHARED, 0],
        [0.0, 0.7, _HEADING, 1],
        [0.0, 0.7, _SHARED, 1],
        [0.25, 0.9, _TOOL, 0],
        [0.0, 1.1, _HEADING, 1],
        [0.3, 1.2, _SHARED, 0],
        [0.0, 1.1, _SHARED, 1],
        [0.4, 1.4, _TOOL, 0],
        # for an arm that would touch itself: shoulder and elbow move apart from the wrist
        [0.0, 0.0, _TOOL, _WRIST_FIRST],
        [0.0, 0.0, _TOOL, _WRIST_LAST],
        [0.0, 0.0, _TOOL, _WRIST_HOME],
        [0.0, 0.3, _SHARED, _WRIST_FIRST],
        [0.0, 0.3, _SHARED, _WRIST_LAST],
        [0.0, 0.3, _SHARED, _WRIST_HOME],
        [0.0, 0.8, _SHARED, _WRIST_FIRST],
        [0.0, 0.8, _SHARED, _WRIST_LAST],
        [0.0, 0.8, _SHARED, _WRIST_HOME],
        # and at last by way of postures that are spread over all that the arm can do
        *([0.0, 0.9, _SHARED, _SPREAD + k] for k in range(_POSTURES)),
    ]
)
"""What is tried, in this order: how far the arm draws the tool back [m] and the base the robot [m]; where the
base goes (along the tool, at both ends along the mean of the tools, straight back); whether the arm is kept,
folds, moves its wrist before the rest, after it, or by way of home, or goes by way of another posture."""

_WRIST = 3
"""Joints of the wrist, the last of the arm."""

_ITERATIONS = 12


def detours(
    chain: KinematicChain,
    start: Float[Array, " joints"],
    goal: Float[Array, " joints"],
    lower: Float[Array, " arm"],
    upper: Float[Array, " arm"],
    home: Float[Array, " arm"],
) -> Float[Array, "ways 2 joints"]:
    """Via points of the ways from `start` to `goal` to be tried: after the retreat, before the approach.

    lower, upper: limits of the arm [rad]. home: the arm folded [rad].
    """
    ends = jnp.stack([start, goal])
    poses = jax.vmap(lambda q: forward(chain, q))(ends)
    shared = _level(-poses.R[0, :, 2] - poses.R[1, :, 2])

    def end(q, other, pose, wrist_first):
        heading = jnp.stack([-jnp.cos(q[2]), -jnp.sin(q[2])])
        back = jnp.stack([_level(-pose.R[:, 2]), shared, heading])
        swaps = WAYS[:, 3] == wrist_first
        return _retreated(chain, q, other, pose, back, swaps, (lower, upper, home))

    # the wrist that goes first has done so at the start's via point, one that goes last has not at the goal's
    rows = zip(ends, ends[::-1], range(2), (_WRIST_FIRST, _WRIST_LAST), strict=True)
    both = [end(q, other, jax.tree.map(lambda x, k=k: x[k], poses), which) for q, other, k, which in rows]
    return jnp.stack(both, axis=1)


def _level(direction: Float[Array, "3"]) -> Float[Array, "2"]:
    """The direction in the plane, unit; nothing where it is upright."""
    x, y = direction[0], direction[1]
    length = jnp.sqrt(x * x + y * y)
    some = length > 1e-3
    safe = jnp.where(some, length, 1)
    return jnp.where(some, 1, 0) * jnp.stack([x / safe, y / safe])


def _retreated(chain: KinematicChain, q, other, pose: Pose, back, swaps: np.ndarray, arm_limits: tuple):
    """`q` after each of the retreats, [ways, joints]; back: the three directions that the base can go; swaps:
    where it has the wrist of the other end.
    """
    lower, upper, home = arm_limits
    base_size = q.shape[0] - home.shape[0]
    arm, settings = arm_chain(chain, q[:base_size]), IKSettings(iterations=_ITERATIONS)
    rows = jnp.asarray(WAYS[:, :2], q.dtype)
    way, folded = back[WAYS[:, 2].astype(int)], (WAYS[:, 3] == _FOLDED) | (WAYS[:, 3] >= _SPREAD)
    spread = spread_starts(home, lower, upper, count=_POSTURES + 1)
    posture = spread[np.maximum(WAYS[:, 3].astype(int) - _SPREAD + 1, 0)]
    homewards = WAYS[:, 3] == _WRIST_HOME
    turned = swaps | homewards
    wrist = jnp.where(homewards[:, None], home[-_WRIST:], other[-_WRIST:])

    def one(retreat, way, folded, posture, turned, wrist):
        target = Pose(pose.p - retreat[0] * pose.R[:, 2], pose.R)
        found = solve(arm, q[None, base_size:], target, lower, upper, settings).q
        found = jnp.where(folded, posture, jnp.where(retreat[0] > 0, found, q[base_size:]))
        arm_there = jnp.concatenate([found[:-_WRIST], jnp.where(turned, wrist, found[-_WRIST:])])
        return jnp.concatenate([q[:2] + retreat[1] * way, q[2:base_size], arm_there])

    return jax.vmap(one)(rows, way, jnp.asarray(folded), posture, jnp.asarray(turned), wrist)
