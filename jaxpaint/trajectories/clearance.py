"""How near a moving robot's body comes to what is around it."""

from collections.abc import Callable

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from jaxpaint.kinematics.chain import KinematicChain
from jaxpaint.kinematics.spheres import Spheres, sphere_centers

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


def clearance(
    chain: KinematicChain,
    spheres: Spheres,
    q: Float[Array, "times joints"],
    distance: Callable[[Float[Array, "3"]], Float[Array, ""]],
) -> Float[Array, " times"]:
    """The least gap [m] between the robot's spheres and a surface, at each joint position; negative inside.

    distance: the signed distance [m] of a point in the map from the surface, positive on the robot's side.
    """

    def at(q_t):
        centers = sphere_centers(chain, spheres, q_t)
        return (jax.vmap(distance)(centers) - spheres.radius).min()

    return jax.vmap(at)(q)


def gap_on_the_way(
    chain: KinematicChain,
    spheres: Spheres,
    q: Float[Array, "times joints"],
    distance: Callable[[Float[Array, "3"]], Float[Array, ""]],
) -> Float[Array, ""]:
    """A lower bound of the gap [m], also between the joint positions that are looked at.

    A sphere that moves by d between two moments comes no nearer than the mean of its two gaps less d / 2.
    """
    centers = sphere_centers_along(chain, spheres, q)
    gap = jax.lax.map(jax.vmap(distance), centers) - spheres.radius
    step = centers[1:] - centers[:-1]
    moved = jnp.sqrt((step * step).sum(-1))
    return jnp.minimum(gap.min(), ((gap[1:] + gap[:-1] - moved) / 2).min(initial=jnp.inf))


def sphere_centers_along(
    chain: KinematicChain, spheres: Spheres, q: Float[Array, "times joints"]
) -> Float[Array, "times spheres 3"]:
    """Where the spheres' centers are at many joint positions [m].

    A loop along the chain: unrolled, a plain program evaluates each joint again for all after it.
    """
    hinge = np.array([kind == "hinge" for kind in chain.kinds])
    angle = jnp.where(hinge, q, 0).T
    slide = jnp.where(hinge, 0, q).T

    def step(carry, joint):
        p, R = carry
        R_offset, p_offset, c, s, way = joint
        p = p + _rotated(R, p_offset + way[:, None] * R_offset[:, 2])
        x, y, z = (_rotated(R, R_offset[None, :, k]) for k in range(3))
        c, s = c[:, None], s[:, None]
        R = jnp.stack([c * x + s * y, c * y - s * x, z], axis=-1)
        return (p, R), (p, R)

    times = q.shape[0]
    start = jnp.zeros((times, 3), q.dtype), jnp.broadcast_to(jnp.eye(3, dtype=q.dtype), (times, 3, 3))
    _, (p, R) = jax.lax.scan(
        step, start, (chain.R_offset, chain.p_offset, jnp.cos(angle), jnp.sin(angle), slide)
    )
    p, R = p[spheres.frame], R[spheres.frame]
    return jnp.swapaxes(p + (R * spheres.center[:, None, None, :]).sum(-1), 0, 1)


def _rotated(R, vector):
    """R v for [times, 3, 3] and [times or 1, 3]."""
    return (R * vector[:, None, :]).sum(-1)
