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
    gap = jax.lax.map(lambda pose: _signed(footprint, pose, there.place, counts), base)
    x, y = _corners(footprint, base)
    dx, dy = x[1:] - x[:-1], y[1:] - y[:-1]
    moved = jnp.sqrt((dx * dx + dy * dy).max(-1))
    return jnp.minimum(gap.min(), ((gap[1:] + gap[:-1] - moved) / 2).min(initial=jnp.inf))


def _signed(footprint, pose, place, counts):
    """Distance of the nearest place from the rectangle, less than zero inside."""
    c, s = jnp.cos(pose[2]), jnp.sin(pose[2])
    x, y = place[:, 0] - pose[0], place[:, 1] - pose[1]
    low, high = footprint.min(0), footprint.max(0)
    ahead, left = c * x + s * y, c * y - s * x
    dx = jnp.maximum(low[0] - ahead, ahead - high[0])
    dy = jnp.maximum(low[1] - left, left - high[1])
    out_x, out_y = jnp.maximum(dx, 0), jnp.maximum(dy, 0)
    outside = jnp.sqrt(out_x * out_x + out_y * out_y)
    return jnp.where(counts, outside + jnp.minimum(jnp.maximum(dx, dy), 0), jnp.inf).min()


def _corners(footprint, base):
    """Where the corners are in the map, [times, 4] of x and of y."""
    c, s = jnp.cos(base[:, 2:]), jnp.sin(base[:, 2:])
    x, y = footprint[:, 0], footprint[:, 1]
    return base[:, :1] + c * x - s * y, base[:, 1:2] + s * x + c * y
