"""A few points of a cloud that stand for all of it, evenly spread."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int, UInt

# Cells along each axis: three times ten bits fill a key.
_CELLS = 1024
_NOWHERE = np.uint32(0xFFFFFFFF)


def sparse(
    points: Float[Array, "n 3"], valid: Bool[Array, " n"], *, count: int, size: float
) -> Float[Array, "count 3"]:
    """At most `count` of the valid points, one in a cube of side `size` [m], NaN in the rows that are left.

    Where more cubes hold points than that, they are taken at even steps along Morton's curve: the camera's
    own order goes by rows of its image, of which a stride keeps a few whole ones and nothing between them.
    What is further than 1024 cubes from the cloud's lowest corner counts as in the last of them.
    """
    valid = valid & jnp.isfinite(points).all(-1)
    lower = jnp.min(jnp.where(valid[:, None], points, jnp.inf), axis=0, initial=jnp.inf)
    cell = jnp.clip(jnp.where(valid[:, None], (points - lower) / size, 0), 0, _CELLS - 1).astype(jnp.int32)
    key = jnp.where(valid, _morton(cell), _NOWHERE)
    key, order = jax.lax.sort((key, jnp.arange(len(points), dtype=jnp.int32)), num_keys=1, is_stable=True)
    first = (key != _NOWHERE) & jnp.concatenate([jnp.ones(1, bool), key[1:] != key[:-1]])
    cubes = jnp.cumsum(first)
    slot = jnp.arange(count)
    wanted = jnp.where(cubes[-1] > count, (2 * slot + 1) * cubes[-1] // (2 * count), slot)
    index = order[jnp.minimum(jnp.searchsorted(cubes, wanted + 1), len(points) - 1)]
    return jnp.where((wanted < cubes[-1])[:, None], points[index], jnp.nan)


def _morton(cell: Int[Array, "n 3"]) -> UInt[Array, " n"]:
    """The bits of the three coordinates in turn: neighbours in it are neighbours in space."""
    x, y, z = (_spread(cell[:, axis].astype(jnp.uint32)) for axis in range(3))
    return x | (y << 1) | (z << 2)


def _spread(bits: UInt[Array, " n"]) -> UInt[Array, " n"]:
    """Ten bits with two zeros after each."""
    for shift, mask in ((16, 0x030000FF), (8, 0x0300F00F), (4, 0x030C30C3), (2, 0x09249249)):
        bits = (bits | (bits << shift)) & jnp.uint32(mask)
    return bits
