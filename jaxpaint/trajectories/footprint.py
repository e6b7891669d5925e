"""How near a moving base's rectangle comes to what stands about it."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.trajectories.clearance import Obstacles


def footprint_gap(
    footprint: Float[Array, "4 2"],
    base: Float[Array, "times 3"],
    there: Obstacles,
    height: Float[Array, ""],
) -> Float[Array, ""]:
    """A lower bound of the rectangle's gap [m] at and between poses (x, y, yaw) of the base; negative inside.

    footprint: its corners in the base's frame [m]. height: what begins above it does not count [m].
    A rectangle whose corners move by d at most comes no nearer than the mean of its two gaps less d / 2.
    """
    counts = there.real & (there.low <= height)

    def least(pose):
        return jnp.where(counts, signed_distance(footprint, pose, there.place)[0], jnp.inf).min()

    gap = jax.lax.map(least, base)
    x, y = _corners(footprint, base)
    dx, dy = x[1:] - x[:-1], y[1:] - y[:-1]
    moved = jnp.sqrt((dx * dx + dy * dy).max(-1))
    return jnp.minimum(gap.min(), ((gap[1:] + gap[:-1] - moved) / 2).min(initial=jnp.inf))


def signed_distance(
    footprint: Float[Array, "corners 2"], pose: Float[Array, "3"], place: Float[Array, "m 2"]
) -> tuple[Float[Array, " m"], Float[Array, "m 2"]]:
    """Distances of places in the map from the rectangle at a pose (x, y, yaw) [m], below zero inside, and
    unit directions to them in the map.

    footprint: corners of the rectangle in its own frame [m]; one corner is a point. From inside the direction
    is that to the nearest side.
    """
    offset = place - pose[:2]
    c, s = jnp.cos(pose[2]), jnp.sin(pose[2])
    local = jnp.stack([c * offset[:, 0] + s * offset[:, 1], c * offset[:, 1] - s * offset[:, 0]], axis=1)
    low, high = footprint.min(0), footprint.max(0)
    local = local - 0.5 * (low + high)
    over = jnp.abs(local) - 0.5 * (high - low)
    outside = jnp.maximum(over, 0.0)
    size = jnp.sqrt((outside**2).sum(1) + 1e-12)
    gap = jnp.where((over > 0).any(1), size, over.max(1))
    side = jnp.where(over >= over.max(1, keepdims=True), 1.0, 0.0)
    way = jnp.sign(local) * jnp.where((over > 0).any(1)[:, None], outside / size[:, None], side)
    return gap, jnp.stack([c * way[:, 0] - s * way[:, 1], s * way[:, 0] + c * way[:, 1]], axis=1)


def _corners(footprint, base):
    """Where the corners are in the map, [times, 4] of x and of y."""
    c, s = jnp.cos(base[:, 2:]), jnp.sin(base[:, 2:])
    x, y = footprint[:, 0], footprint[:, 1]
    return base[:, :1] + c * x - s * y, base[:, 1:2] + s * x + c * y
