"""How near the parts of a moving robot come to each other."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.kinematics.chain import KinematicChain
from jaxpaint.kinematics.spheres import Spheres, sphere_centers
from jaxpaint.trajectories.clearance import sphere_centers_looped

_JOINED = 2
"""Parts of links so many joints apart, as in a wrist, may be near each other always."""


def own_gap(
    chain: KinematicChain,
    spheres: Spheres,
    home: Float[Array, " joints"],
    q: Float[Array, "times joints"],
    *,
    base_size: int = 3,
) -> Float[Array, ""]:
    """A lower bound of the gap between parts of the robot [m], also between the joint positions that are
    looked at; negative where they overlap.

    Pairs on links that are joined do not count, nor do those whose spheres overlap at `home`: there the robot
    is known to be whole. Where two spheres move by d and e between two moments their gap is no less than the
    mean of its two values less (d + e) / 2.
    """
    apart = jnp.abs(spheres.frame[:, None] - spheres.frame[None]) > _JOINED
    touching = spheres.radius[:, None] + spheres.radius[None]
    # the base carries all of them alike: it stands still
    still = jnp.arange(q.shape[1]) < base_size

    def placed(row):
        return sphere_centers_looped(chain, spheres, jnp.where(still, 0, row))

    def apart_by(centers):
        away = centers[:, None] - centers[None]
        return jnp.sqrt((away * away).sum(-1)) - touching

    counts = apart & (apart_by(placed(home)) > 0)

    def gaps(centers):
        return jnp.where(counts, apart_by(centers), jnp.inf)

    first = placed(q[0])

    def between(before, row):
        (old, gap_before), centers = before, placed(row)
        gap = gaps(centers)
        step = centers - old
        moved = jnp.sqrt((step * step).sum(-1))
        bound = (gap + gap_before - moved[:, None] - moved[None]) / 2
        return (centers, gap), jnp.minimum(gap.min(), bound.min())

    _, least = jax.lax.scan(between, (first, gaps(first)), q)
    return least.min()


def own_gap_at(
    chain: KinematicChain, spheres: Spheres, home: Float[Array, " joints"], q: Float[Array, " joints"]
) -> Float[Array, ""]:
    """The least gap between parts of the robot at one posture [m]: pairs as in `own_gap`."""
    apart = jnp.abs(spheres.frame[:, None] - spheres.frame[None]) > _JOINED
    touching = spheres.radius[:, None] + spheres.radius[None]

    def gaps(row):
        centers = sphere_centers(chain, spheres, row)
        away = centers[:, None] - centers[None]
        return jnp.sqrt((away * away).sum(-1)) - touching

    return jnp.where(apart & (gaps(home) > 0), gaps(q), jnp.inf).min()
