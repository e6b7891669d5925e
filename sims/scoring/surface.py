"""Points of the true surface, which a measured cloud is compared with."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from sims.scenes.charts import AbstractChart


def surface_samples(
    chart: AbstractChart, lower: Float[Array, "2"], upper: Float[Array, "2"], *, columns: int, rows: int
) -> Float[Array, "samples 3"]:
    """Points of the true surface on an even (u, v) grid over a rectangle [m], rows x columns of them."""
    u = lower[0] + (upper[0] - lower[0]) * (jnp.arange(columns) + 0.5) / columns
    v = lower[1] + (upper[1] - lower[1]) * (jnp.arange(rows) + 0.5) / rows
    uv = jnp.stack(jnp.meshgrid(u, v), axis=-1).reshape(-1, 2)
    return jax.vmap(chart.point)(uv)
