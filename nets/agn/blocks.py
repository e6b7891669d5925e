"""Clouds in blocks of neighbours: the leaves of a balanced k-d tree, all of one size."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

BLOCK = 8
"""Points of a block: an anchor stands for them."""
GROUP = 8
"""Anchors of a group: one of them stands for it where graphs reach far."""


def padded_size(count: int, least: int = BLOCK) -> int:
    """Rows that `block_order` can halve until blocks are left: a power of two, `least` or more."""
    return max(least, 1 << max(count - 1, 0).bit_length())


def block_order(points: Float[Array, "n 3"], valid: Bool[Array, " n"]) -> Int[Array, " n"]:
    """An order in which every aligned run of a power of two of rows, from `BLOCK` on, is compact.

    Halves the cloud at its median along the longer side, and each half again. n: a power of two. What is not
    valid comes last in each half, so that whole blocks at the end are empty. Any density is fine: no cell
    size has to be known.
    """
    n = len(points)
    if n < BLOCK or n & (n - 1):
        raise ValueError(f"points: found {n} rows, allowed: a power of two, {BLOCK} or more")
    index = jnp.arange(n, dtype=jnp.int32)[None]
    while index.shape[1] > BLOCK:
        index = _halved(index, points, valid)
    return index.reshape(-1)


def _halved(index: Int[Array, "parts size"], points, valid) -> Int[Array, "more half"]:
    here, real = points[index], valid[index][..., None]
    lower = jnp.where(real, here, jnp.inf).min(1)
    upper = jnp.where(real, here, -jnp.inf).max(1)
    side = (upper - lower).argmax(-1)
    along = jnp.take_along_axis(here, side[:, None, None], axis=2)[..., 0]
    along = jnp.where(real[..., 0], along, jnp.inf)
    _, index = jax.lax.sort((along, index), num_keys=1, is_stable=True)
    return index.reshape(2 * index.shape[0], -1)
