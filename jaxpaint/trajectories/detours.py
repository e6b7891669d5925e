"""Ways around: where the straight motion would touch something, retreat first, go, and approach."""

from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from jaxpaint.kinematics.chain import KinematicChain, arm_chain, forward
from jaxpaint.kinematics.ik import IKSettings, solve
from jaxpaint.kinematics.pose import Pose

RETREATS = np.array(
    [[0, 0], [0.12, 0], [0.25, 0], [0, 0.25], [0.15, 0.25], [0, 0.5], [0.25, 0.5], [0.25, 0.9], [0.4, 1.4]]
)
"""What is tried, in this order: how far the tool is drawn back by the arm, and the robot by its base [m]."""

TOGETHER = np.array([[0, 0.3], [0.15, 0.4], [0, 0.6], [0.2, 0.8], [0.3, 1.2]])
"""The same, but at both ends the base goes the same way, between the tools' ways back: out of a corner."""

_ITERATIONS = 12


def detours(
    chain: KinematicChain,
    start: Float[Array, " joints"],
    goal: Float[Array, " joints"],
    lower: Float[Array, " arm"],
    upper: Float[Array, " arm"],
) -> Float[Array, "ways 2 joints"]:
    """Via points of the ways from `start` to `goal` to be tried: after the retreat, before the approach.

    The first way is straight: its via points are the ends themselves. lower, upper: limits of the arm [rad].
    """
    base_size = chain.size - lower.shape[0]
    poses = [forward(chain, q) for q in (start, goal)]
    back = [_level(-pose.R[:, 2]) for pose in poses]
    both = _level(-poses[0].R[:, 2] - poses[1].R[:, 2])

    def ways(q, pose, back):
        own = _retreated(chain, q, pose, back, RETREATS, (lower, upper), base_size)
        shared = _retreated(chain, q, pose, both, TOGETHER, (lower, upper), base_size)
        return jnp.concatenate([own, shared])

    return jnp.stack([ways(*end) for end in zip((start, goal), poses, back, strict=True)], axis=1)


def choose(
    start: Float[Array, " joints"],
    goal: Float[Array, " joints"],
    ways: Float[Array, "ways 2 joints"],
    gap: Callable[[Float[Array, "4 joints"]], Float[Array, ""]],
    margin: Float[Array, ""],
) -> tuple[Float[Array, "2 joints"], Bool[Array, ""], Float[Array, ""]]:
    """The first way whose gap [m] is at least `margin`, else the one with the largest.

    Returns its via points, whether there are any, its gap.

    Ways are looked at one after the other, and none after one that will do: usually the first is enough.
    """

    def points(index):
        return jnp.concatenate([start[None], ways[index], goal[None]])

    def goes_on(state):
        index, _, best = state
        return (index < ways.shape[0]) & (best < margin)

    def look(state):
        index, chosen, best = state
        found = gap(points(index))
        better = found > best
        return index + 1, jnp.where(better, index, chosen), jnp.where(better, found, best)

    zero = jnp.zeros((), jnp.int32)
    _, chosen, best = jax.lax.while_loop(goes_on, look, (zero, zero, jnp.full((), -jnp.inf, start.dtype)))
    return ways[chosen], chosen > 0, best


def _level(direction: Float[Array, "3"]) -> Float[Array, "2"]:
    """The direction in the plane, unit; nothing where it is upright."""
    x, y = direction[0], direction[1]
    length = jnp.sqrt(x * x + y * y)
    some = length > 1e-3
    safe = jnp.where(some, length, 1)
    return jnp.where(some, 1, 0) * jnp.stack([x / safe, y / safe])


def _retreated(chain: KinematicChain, q, pose: Pose, back, retreats, limits: tuple, base_size: int):
    """`q` after each of the retreats, [ways, joints]; the base goes along `back`."""
    arm = arm_chain(chain, q[:base_size])
    settings = IKSettings(iterations=_ITERATIONS)
    lower, upper = limits

    def one(retreat):
        target = Pose(pose.p - retreat[0] * pose.R[:, 2], pose.R)
        found = solve(arm, q[None, base_size:], target, lower, upper, settings).q
        found = jnp.where(retreat[0] > 0, found, q[base_size:])
        return jnp.concatenate([q[:2] + retreat[1] * back, q[2:base_size], found])

    return jax.vmap(one)(jnp.asarray(retreats, q.dtype))
