"""Chamfer distance of a scanned cloud to a surface that is known everywhere."""

from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from jaxpaint.clouds import Chamfer
from sims.scoring.surface import surface_samples

# Samples of the true surface that look for their nearest point of the cloud.
_COLUMNS, _ROWS = 48, 20
_BLOCK = 64


def chamfer_to_chart(
    chart: Any,
    cloud: Float[Array, "points 3"],
    valid: Bool[Array, " points"],
    lower: Float[Array, "2"],
    upper: Float[Array, "2"],
) -> Chamfer:
    """S1-(1) between the cloud over a rectangle of (u, v) and the true surface there, densely sampled.

    From cloud to surface the distance is exact, by the chart: the limit of ever denser truth. From surface
    to cloud it is that of an even sample, and contains the cloud's own spacing. Conventions as `chamfer`.
    """
    uv, height = jax.vmap(chart.to_uv)(cloud)
    inside = valid & (uv >= lower).all(-1) & (uv <= upper).all(-1) & jax.vmap(chart.on_surface)(uv)
    truth = surface_samples(chart, lower, upper, columns=_COLUMNS, rows=_ROWS)
    places = jnp.where(valid[:, None], cloud, 1e3).T

    def nearest(samples):
        squares = [(samples[:, axis, None] - places[axis][None]) ** 2 for axis in range(3)]
        return (squares[0] + squares[1] + squares[2]).min(1)

    back = jax.lax.map(nearest, truth.reshape(-1, _BLOCK, 3)).reshape(-1)
    count = jnp.maximum(inside.sum(), 1)
    distance = jnp.where(inside, jnp.abs(height), 0.0)
    l1 = (distance.sum() / count + jnp.sqrt(back).mean()) / 2
    return Chamfer(l1, (distance**2).sum() / count + back.mean())
