"""A threshold as a hard rule or as its smooth relaxation."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float


def exceeds(
    value: Float[Array, "*s"], threshold: Float[Array, "*s"], temperature: Float[Array, ""]
) -> Float[Array, "*s"]:
    """1 where `value >= threshold`, else 0; with a temperature > 0 a logistic curve of that width.

    Infinite thresholds are never exceeded, at any temperature.
    """
    hot = temperature > 0
    width = jnp.where(hot, temperature, 1.0)
    finite = jnp.isfinite(threshold)
    gap = value - jnp.where(finite, threshold, 0.0)
    soft = jax.nn.sigmoid(jnp.clip(gap / width, -40.0, 40.0))
    hard = (gap >= 0).astype(gap.dtype)
    return jnp.where(finite, jnp.where(hot, soft, hard), 0.0)
