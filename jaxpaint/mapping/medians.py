"""The usual value of an array of which only some entries count."""

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float


def median_of(values: Float[Array, "n"], counts: Bool[Array, "n"]) -> Float[Array, ""]:
    """The upper median of the finite values that count; NaN where there is none.

    One sort: a fraction of what jnp.nanmedian takes to compile.
    """
    counts = counts & jnp.isfinite(values)
    number = jnp.sum(counts)
    middle = jnp.sort(jnp.where(counts, values, jnp.inf))[number // 2]
    return jnp.where(number > 0, middle, jnp.nan)
