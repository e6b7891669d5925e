"""Motion within the motors' torques: what is too steep is planned gentler, and slowed down until it holds."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from jaxpaint.kinematics.chain import KinematicChain
from jaxpaint.kinematics.dynamics import Inertia, inverse_dynamics
from jaxpaint.trajectories.waypoints import Limits, Trajectory, on_segment, plan_base_and_arm, slowed

# Of each segment so many moments are looked at; the torque between them is kept by a share of the limit, or,
# where the weight alone takes nearly as much, by half of what it leaves.
_NODES, _SHARE = 80, 0.97
# A motor that can move its links only this slowly, as a share of the speed, cannot move them.
_SLOWEST = 0.02
# Accelerations that are tried, as shares of the limit: a weak motor is better helped by them than by time.
_GENTLER = (1.0, 0.6, 0.3)


def plan_within_torque(
    waypoints: Float[Array, "waypoints joints"],
    mask: Bool[Array, " waypoints"],
    limits: Limits,
    rest: float | Float[Array, " waypoints"],
    chain: KinematicChain,
    inertia: Inertia,
    torque: Float[Array, " joints"],
    *,
    base_size: int = 3,
) -> tuple[Trajectory, Bool[Array, " segments"]]:
    """As `plan_base_and_arm`, and no motor gives more than `torque` [N m or N]; on which segments that is so.

    Every segment takes the acceleration with which it is shortest. Where a motor cannot even hold its links'
    weight somewhere on the way, with hardly anything to spare, that segment is not kept within its torque and
    must not be driven.
    """

    def plan(share):
        gentle = Limits(limits.speed, limits.acceleration * share)
        trajectory = plan_base_and_arm(waypoints, mask, gentle, rest, base_size=base_size)
        factor, strong = slow_down(trajectory, chain, inertia, torque)
        return slowed(trajectory, factor), strong

    tried, strong = jax.vmap(plan)(jnp.asarray(_GENTLER, waypoints.dtype))
    best = jnp.argmin(jnp.where(strong, tried.segments, jnp.inf), axis=0)
    chosen = best == np.arange(len(_GENTLER))[:, None]

    def pick(leaf):
        return jnp.where(chosen, leaf, 0).sum(0)

    base, arm = jax.tree.map(pick, (tried.base, tried.arm))
    first = jax.tree.map(lambda leaf: leaf[0], tried)
    same = Trajectory(first.points, base, arm, first.start, first.rest, first.duration, base_size)
    return slowed(same, jnp.ones_like(first.start)), pick(strong) > 0


def slow_down(
    trajectory: Trajectory, chain: KinematicChain, inertia: Inertia, torque: Float[Array, " joints"]
) -> tuple[Float[Array, " segments"], Bool[Array, " segments"]]:
    """By what factor each segment must take longer for the torques to hold, 1 where they do, and whether
    there is one: 1 and False where a motor is too weak for the weight.

    At a share x of the speed the motors give weight + x damping + x^2 (inertia and Coriolis), so that the
    largest x is the root of a quadratic.
    """
    share = jnp.asarray((np.arange(_NODES) + 0.5) / _NODES, trajectory.start.dtype)

    def at(segment, part):
        s = on_segment(trajectory, segment, part * trajectory.segments[segment])
        # at rest and in motion, as one program of two rows
        v, a = (jnp.stack([0 * x, x]) for x in (s.v, s.a))
        weight, whole = jax.vmap(lambda v, a: inverse_dynamics(chain, inertia, s.p, v, a))(v, a)
        damping = inertia.damping * s.v
        limit = jnp.maximum(_SHARE * torque, (jnp.abs(weight) + torque) / 2)
        return _largest_share(weight, damping, whole - weight - damping, limit).min()

    segments = jnp.arange(trajectory.start.shape[0])
    found = jax.vmap(lambda k: jax.vmap(lambda part: at(k, part))(share).min())(segments)
    strong = found >= _SLOWEST
    return 1 / jnp.where(strong, found, 1), strong


def _largest_share(weight, damping, inertial, limit):
    """The largest x up to 1 with |weight + x damping + x^2 inertial| <= limit, for each joint; 0 where the
    weight is too much.
    """

    def upper(c, b, a):
        c = c - limit
        root = b * b - 4 * a * c
        below = b + jnp.sqrt(jnp.maximum(root, 0))
        met = (c < 0) & (root >= 0) & (below > 0)
        share = jnp.where(met, jnp.minimum(-2 * c / jnp.where(met, below, 1), 1), 1)
        return jnp.where(c < 0, share, 0)

    x = jnp.minimum(upper(weight, damping, inertial), upper(-weight, -damping, -inertial))
    return jnp.where(jnp.isfinite(x), x, 1)
