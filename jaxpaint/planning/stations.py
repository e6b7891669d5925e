"""Base poses along a brush path: as much as possible from each, and the wall kept at a distance."""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.planning.stretches import ReachWindow, serving_places
from jaxpaint.trajectories.footprint import signed_distance


class StationSettings(eqx.Module):
    """reach: what one station may serve. clearance: least distance of the base's footprint, or of its middle
    where no footprint is given, from the mapped surface [m]. footprint: corners of the base's rectangle in
    its frame [m].
    """

    reach: ReachWindow
    clearance: Float[Array, ""]
    footprint: Float[Array, "corners 2"] | None = None


def plan_stations(
    position: Float[Array, "t 3"],
    axis: Float[Array, "t 3"],
    weight: Float[Array, "t"],
    surface: Float[Array, "s 3"],
    surface_weight: Float[Array, "s"],
    home: Float[Array, "2"],
    settings: StationSettings,
) -> Float[Array, "t 3"]:
    """Base pose (x, y, yaw) in the map frame at each time of a path.

    position, axis: brush position [m] and axis (into the wall) along the path. weight: 1 where the pen is
    down. surface: points that the base must keep away from. home: brush in the base frame where the arm works
    best (x, y) [m].

    One station serves as long a stretch as stays in reach of it (`serving_places`), and what comes next is
    its own as soon as the pen is up. Where that is too near to the surface it is pushed away, nearest point
    first.
    """
    base = serving_places(position, axis, weight, home, settings.reach)
    for _ in range(6):
        base = jax.lax.map(lambda b: _pushed(b, surface[:, :2], surface_weight, settings), base)
    return base


def _pushed(base: Float[Array, "3"], surface: Float[Array, "s 2"], weight, settings: StationSettings):
    """The base pose, moved straight away from the nearest surface point to at least the clearance."""
    body = jnp.zeros((1, 2), base.dtype) if settings.footprint is None else settings.footprint
    gap, towards = signed_distance(body, base, surface)
    gap = jnp.where(weight > 0, gap, jnp.inf)
    nearest = jnp.argmin(gap)
    missing = jnp.maximum(settings.clearance - gap[nearest], 0.0)  # 0 where there is no point at all
    return base.at[:2].add(-missing * towards[nearest])
