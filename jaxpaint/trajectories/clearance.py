"""How near a moving robot's body comes to what is around it."""

from collections.abc import Callable

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from jaxpaint.kinematics.chain import KinematicChain
from jaxpaint.kinematics.frame_loop import looped_frames
from jaxpaint.kinematics.spheres import Spheres

_FAR = 1e3
"""Distance of what is not there [m]."""


class Obstacles(eqx.Module):
    """Upright sticks, each over one place of the floor: a scanned point is one without length.

    place: (x, y) in the map frame [m]. low, high: between which heights each stands [m]. real: whether it is
    there.
    """

    place: Float[Array, "m 2"]
    low: Float[Array, " m"]
    high: Float[Array, " m"]
    real: Bool[Array, " m"]

    @staticmethod
    def points(p_map: Float[Array, "m 3"]) -> "Obstacles":
        """Scanned points; NaN is no point."""
        real = jnp.isfinite(p_map).all(-1)
        safe = jnp.where(real[:, None], p_map, 0)
        return Obstacles(safe[:, :2], safe[:, 2], safe[:, 2], real)

    @staticmethod
    def sticks(place: Float[Array, "m 2"], high: Float[Array, " m"]) -> "Obstacles":
        """What a lidar saw, from the floor up to `high`; NaN is no echo."""
        real = jnp.isfinite(place).all(-1)
        return Obstacles(jnp.where(real[:, None], place, 0), jnp.full_like(high, -_FAR), high, real)

    def __add__(self, other: "Obstacles") -> "Obstacles":
        """All of both."""
        return jax.tree.map(lambda a, b: jnp.concatenate([a, b]), self, other)

    def distance(self, p: Float[Array, "3"]) -> Float[Array, ""]:
        """From a point to the nearest [m]."""
        x, y = p[0] - self.place[:, 0], p[1] - self.place[:, 1]
        z = jnp.maximum(jnp.maximum(self.low - p[2], p[2] - self.high), 0)
        return jnp.sqrt(jnp.where(self.real, x * x + y * y + z * z, _FAR * _FAR).min())


def gap_on_the_way(
    chain: KinematicChain,
    spheres: Spheres,
    q: Float[Array, "times joints"],
    distance: Callable[[Float[Array, "3"]], Float[Array, ""]],
) -> Float[Array, ""]:
    """A lower bound of the gap [m], also between the joint positions that are looked at; negative inside.

    distance: of a point in the map from what is around [m], positive on the robot's side.
    A sphere that moves by d between two moments comes no nearer than the mean of its two gaps less d / 2.
    """
    centers = jax.vmap(lambda row: sphere_centers_looped(chain, spheres, row))(q)
    gap = jax.lax.map(jax.vmap(distance), centers) - spheres.radius
    step = centers[1:] - centers[:-1]
    moved = jnp.sqrt((step * step).sum(-1))
    return jnp.minimum(gap.min(), ((gap[1:] + gap[:-1] - moved) / 2).min(initial=jnp.inf))


def sphere_centers_looped(
    chain: KinematicChain, spheres: Spheres, q: Float[Array, " joints"]
) -> Float[Array, "spheres 3"]:
    """Where the centers are in the map [m], by a loop along the chain: unrolled, a plain program evaluates
    each joint again for all after it.
    """
    links = looped_frames(chain, q)
    p, R = links.p[spheres.frame], links.R[spheres.frame]
    return p + (R * spheres.center[:, None, :]).sum(-1)
