"""Where a ray meets a cloud first: a surface, not a single flying point."""

from collections.abc import Callable

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from jaxpaint.clouds.neighbours import Cells

Near = Callable[[Array, Array, Array], Array]

SUPPORT = 3
"""Points at one depth that make a surface; fewer are flying points."""
_CROSS, _FRONT_MOST = 12, 40
"""Points taken of each of the 9 cells about a ray, and how many of all these are looked at, by depth."""


def front(
    ray: Float[Array, "2"], cells: Cells, near: Near
) -> tuple[Float[Array, ""], Bool[Array, ""], Bool[Array, ""]]:
    """Depth of the first surface along a ray [m]; whether points are near the ray; whether they are a
    surface.

    A point belongs to a surface when it is one of three within a cell's width in depth. near: says which
    points are near the ray, from their squared distance from it [m^2], their depth [m] and the spacing of the
    first surface about the ray [m]. The depth is that of the surface's point closest to the ray.
    """
    first, count = cells.between(ray, 1, -jnp.inf, jnp.inf)
    points, real = cells.take(first, count, _CROSS)
    across = jnp.square(points[0] - ray[0]) + jnp.square(points[1] - ray[1])
    real = real & (across <= jnp.square(cells.size))
    depth, order = jax.lax.top_k(jnp.where(real, -points[2], -jnp.inf), _FRONT_MOST)
    depth, across = -depth, across[order]
    surface = _supported(depth, cells.size)
    number = jnp.sum(_first_part(depth, surface, cells.size))
    spacing = cells.size * jnp.sqrt(jnp.pi / jnp.maximum(number, 1))
    close = near(across, depth, spacing) & jnp.isfinite(depth)
    part = close & _first_part(depth, close & surface, cells.size)
    closest = jnp.argmin(jnp.where(part, across, jnp.inf))
    return jnp.where(part.any(), depth[closest], 0), jnp.sum(close) >= SUPPORT, part.any()


def _first_part(
    depth: Float[Array, "K"], surface: Bool[Array, "K"], gap: Float[Array, ""]
) -> Bool[Array, "K"]:
    """Points of the first surface among ascending depths: no gap [m] between them and its first point."""
    reached = jnp.cumsum(surface) > 0
    open_ = reached & jnp.pad(reached[:-1], (1, 0)) & (jnp.diff(depth, prepend=depth[:1]) > gap)
    return surface & (jnp.cumsum(open_) == 0)


def _supported(depth: Float[Array, "K"], gap: Float[Array, ""]) -> Bool[Array, "K"]:
    """Which of the ascending depths are among `SUPPORT` within the gap [m]."""
    more = SUPPORT - 1
    there = jnp.isfinite(depth)
    depth = jnp.where(there, depth, 0)  # infinity less infinity is no number
    whole = there[more:] & (depth[more:] - depth[:-more] <= gap)
    whole = jnp.pad(whole, (more, more))
    return jnp.stack([whole[more - k : whole.shape[0] - k] for k in range(SUPPORT)]).any(0)
