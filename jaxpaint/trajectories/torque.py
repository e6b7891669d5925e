"""Motion within the motors' torques: what is too steep is planned gentler, and slowed down until it holds."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from jaxpaint.kinematics.chain import KinematicChain
from jaxpaint.kinematics.dynamics import Inertia, inverse_dynamics
from jaxpaint.trajectories.waypoints import Limits, Trajectory, on_segment, plan_base_and_arm, slowed

# Of each segment so many moments are looked at; the torque between them is kept by a share of the limit.
_NODES, _SHARE = 80, 0.97
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
) -> Trajectory:
    """As `plan_base_and_arm`, and no motor gives more than `torque` [N m or N].

    Every segment takes the acceleration with which it is shortest. A joint that cannot even hold its links'
    weight somewhere on the way does not count there.
    """

    def plan(share):
        gentle = Limits(limits.speed, limits.acceleration * share)
        trajectory = plan_base_and_arm(waypoints, mask, gentle, rest, base_size=base_size)
        return slowed(trajectory, slow_down(trajectory, chain, inertia, torque))

    tried = jax.vmap(plan)(jnp.asarray(_GENTLER, waypoints.dtype))
    best = jnp.argmin(tried.segments, axis=0)
    chosen = best == np.arange(len(_GENTLER))[:, None]

    def pick(leaf):
        return jnp.where(chosen, leaf, 0).sum(0)

    base, arm = jax.tree.map(pick, (tried.base, tried.arm))
    first = jax.tree.map(lambda leaf: leaf[0], tried)
    same = Trajectory(first.points, base, arm, first.start, first.rest, first.duration, base_size)
    return slowed(same, jnp.ones_like(first.start))


def slow_down(
    trajectory: Trajectory, chain: KinematicChain, inertia: Inertia, torque: Float[Array, " joints"]
) -> Float[Array, " segments"]:
    """By what factor each segment must take longer for the torques to hold, 1 where they do.

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
        return _largest_share(weight, damping, whole - weight - damping, _SHARE * torque).min()

    segments = jnp.arange(trajectory.start.shape[0])
    found = jax.vmap(lambda k: jax.vmap(lambda part: at(k, part))(share).min())(segments)
    return 1 / found


def _largest_share(weight, damping, inertial, limit):
    """The largest x up to 1 with |weight + x damping + x^2 inertial| <= limit, for each joint."""

    def upper(c, b, a):
        c = c - limit
        root = b * b - 4 * a * c
        below = b + jnp.sqrt(jnp.maximum(root, 0))
        met = (c < 0) & (root >= 0) & (below > 0)
        return jnp.where(met, jnp.minimum(-2 * c / jnp.where(met, below, 1), 1), 1)

    x = jnp.minimum(upper(weight, damping, inertial), upper(-weight, -damping, -inertial))
    return jnp.where(jnp.isfinite(x), x, 1)
