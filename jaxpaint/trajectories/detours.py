"""Ways around: where the straight motion would touch something, retreat first, go, and approach."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from jaxpaint.kinematics.chain import KinematicChain, arm_chain, forward
from jaxpaint.kinematics.ik import IKSettings, solve
from jaxpaint.kinematics.pose import Pose

_TOOL, _SHARED, _HEADING = range(3)

WAYS = np.array(
    [
        # tool, base, where the base goes, arm folded
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
    ]
)
"""What is tried, in this order: how far the arm draws the tool back [m] and the base the robot [m]; where the
base goes (along the tool, at both ends along the mean of the tools, straight back); whether the arm folds."""

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

    def end(q, pose):
        heading = jnp.stack([-jnp.cos(q[2]), -jnp.sin(q[2])])
        back = jnp.stack([_level(-pose.R[:, 2]), shared, heading])
        return _retreated(chain, q, pose, back, (lower, upper, home))

    return jnp.swapaxes(jax.vmap(end)(ends, poses), 0, 1)


def _level(direction: Float[Array, "3"]) -> Float[Array, "2"]:
    """The direction in the plane, unit; nothing where it is upright."""
    x, y = direction[0], direction[1]
    length = jnp.sqrt(x * x + y * y)
    some = length > 1e-3
    safe = jnp.where(some, length, 1)
    return jnp.where(some, 1, 0) * jnp.stack([x / safe, y / safe])


def _retreated(chain: KinematicChain, q, pose: Pose, back, arm_limits: tuple):
    """`q` after each of the retreats, [ways, joints]; back: the three directions that the base can go."""
    lower, upper, home = arm_limits
    base_size = q.shape[0] - home.shape[0]
    arm, settings = arm_chain(chain, q[:base_size]), IKSettings(iterations=_ITERATIONS)
    rows = jnp.asarray(WAYS[:, :2], q.dtype)
    way, folded = back[WAYS[:, 2].astype(int)], WAYS[:, 3] > 0

    def one(retreat, way, folded):
        target = Pose(pose.p - retreat[0] * pose.R[:, 2], pose.R)
        found = solve(arm, q[None, base_size:], target, lower, upper, settings).q
        found = jnp.where(folded, home, jnp.where(retreat[0] > 0, found, q[base_size:]))
        return jnp.concatenate([q[:2] + retreat[1] * way, q[2:base_size], found])

    return jax.vmap(one)(rows, way, jnp.asarray(folded))
