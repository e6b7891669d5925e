"""Base poses along a brush path: what comes next in easy reach, and the wall kept at a distance."""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float


class StationSettings(eqx.Module):
    """horizon: how much of the path ahead a station serves [s]. clearance: least distance of the base's
    middle from the mapped surface [m].
    """

    horizon: Float[Array, ""]
    clearance: Float[Array, ""]


def plan_stations(
    time: Float[Array, "t"],
    position: Float[Array, "t 3"],
    axis: Float[Array, "t 3"],
    weight: Float[Array, "t"],
    surface: Float[Array, "s 3"],
    surface_weight: Float[Array, "s"],
    home: Float[Array, "2"],
    settings: StationSettings,
) -> Float[Array, "t 3"]:
    """Base pose (x, y, yaw) in the map frame at each time of a path.

    position, axis: brush position [m] and axis (into the wall) at equal steps of time. weight: 1 where the
    pen is down; the rest counts little. surface: points that the base must keep away from. home: brush in the
    base frame where the arm works best (x, y) [m].

    A station serves the mean of the next `horizon` seconds: the base faces along the mean axis and has the
    mean position at `home`. Where that is too near to the surface it is pushed away, nearest point first.
    """
    ahead = _window_mean(
        time, jnp.concatenate([position[:, :2], axis[:, :2]], axis=1), weight + 1e-3, settings.horizon
    )
    yaw = jnp.arctan2(ahead[:, 3], ahead[:, 2])
    c, s = jnp.cos(yaw), jnp.sin(yaw)
    x = ahead[:, 0] - c * home[0] + s * home[1]
    y = ahead[:, 1] - s * home[0] - c * home[1]
    place = jnp.stack([x, y], axis=1)
    for _ in range(6):
        place = jax.lax.map(lambda p: _pushed(p, surface[:, :2], surface_weight, settings.clearance), place)
    return jnp.concatenate([place, jnp.unwrap(yaw)[:, None]], axis=1)


def _window_mean(time, values, weight, horizon):
    """Weighted mean of rows from each time to `horizon` later, by differences of sums."""
    zero = jnp.zeros((1, values.shape[1] + 1), values.dtype)
    sums = jnp.concatenate(
        [zero, jnp.cumsum(jnp.concatenate([values, weight[:, None] ** 0], 1) * weight[:, None], 0)]
    )
    last = jnp.searchsorted(time, time + horizon, side="right")
    total = sums[last] - sums[jnp.arange(time.shape[0])]
    return total[:, :-1] / total[:, -1:]


def _pushed(place: Float[Array, "2"], surface: Float[Array, "s 2"], weight, clearance) -> Float[Array, "2"]:
    """The place, moved away from the nearest surface point to at least the clearance."""
    distance = jnp.where(weight > 0, ((surface - place) ** 2).sum(1), jnp.inf)
    nearest = jnp.argmin(distance)
    away = place - surface[nearest]
    size = jnp.sqrt((away**2).sum() + 1e-12)
    found = jnp.isfinite(distance[nearest])
    return place + jnp.where(found, jnp.maximum(clearance - size, 0.0), 0.0) * away / size
