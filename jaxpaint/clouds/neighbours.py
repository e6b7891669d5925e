"""Neighbours of a ray in a cloud: points in square cells across the ray, ordered by depth in each."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, ArrayLike, Bool, Float, Int, UInt

_CELLS = 1024
"""Cells along each side of the grid: with the depth bins they fill a 32-bit key, one fast sort."""
_BINS = 4096
_NOWHERE = np.uint32(0xFFFFFFFF)


class Cells(eqx.Module):
    """A cloud sorted by cell, and by depth within a cell.

    key: cell row, cell column and depth bin in one number, ascending; invalid points come last. points: the
    cloud in the same order, a row for each of two coordinates across the ray and the depth along it [m].
    lower: corner of cell (0, 0) [m]. size: side of a cell [m]. near, step: depth of bin 0 and bin width [m].
    """

    key: UInt[Array, "N"]
    points: Float[Array, "3 N"]
    lower: Float[Array, "2"]
    size: Float[Array, ""]
    near: Float[Array, ""]
    step: Float[Array, ""]

    def between(
        self, uv: Float[Array, "2"], reach: int, near: Float[ArrayLike, ""], far: Float[ArrayLike, ""]
    ) -> tuple[Int[Array, "cells"], Int[Array, "cells"]]:
        """First index and number of points in depth [near, far], for the (2 reach + 1)^2 cells about uv.

        Every point within reach * size of uv lies in one of these cells.
        """
        around = np.stack(np.meshgrid(*[np.arange(-reach, reach + 1)] * 2, indexing="ij"), -1).reshape(-1, 2)
        cell = jnp.clip(_cell(uv, self.lower, self.size) + around, 0, _CELLS - 2)
        # one search for both ends, one program: keys are whole numbers
        ends = jnp.stack([_key(cell, self._bin(near)), _key(cell, self._bin(far)) + 1])
        first, last = jnp.searchsorted(self.key, ends)
        return first, jnp.maximum(last - first, 0)

    def take(
        self, first: Int[Array, "cells"], count: Int[Array, "cells"], most: int
    ) -> tuple[Float[Array, "3 K"], Bool[Array, "K"]]:
        """At most `most` points of every cell, evenly spread over its depth order, and which are real.

        A row for each coordinate: sums over the points are several times faster so than with points as rows.
        """
        slot = jnp.arange(most)
        spread = (2 * slot + 1) * count[:, None] // (2 * most)
        index = first[:, None] + jnp.where(count[:, None] > most, spread, slot)
        index = jnp.minimum(index, self.key.shape[0] - 1).reshape(-1)
        return self.points[:, index], (slot < count[:, None]).reshape(-1)

    def _bin(self, depth: Float[ArrayLike, ""]) -> Int[Array, ""]:
        return jnp.clip((depth - self.near) / self.step, 0, _BINS - 1).astype(jnp.int32)


def bin_points(
    points: Float[Array, "N 3"], valid: Bool[Array, "N"], lower: Float[Array, "2"], size: Float[Array, ""]
) -> Cells:
    """Sort a cloud into cells of side `size` [m] from `lower`; what lies outside the grid is left out.

    points: two coordinates across the ray and the depth along it [m]. A point with a NaN is left out.
    """
    cell = _cell(points[:, :2], lower, size)
    inside = valid & jnp.isfinite(points).all(-1) & ((cell >= 0) & (cell < _CELLS - 1)).all(-1)
    depth = points[:, 2]
    near = jnp.min(jnp.where(inside, depth, jnp.inf), initial=jnp.inf)
    far = jnp.max(jnp.where(inside, depth, -jnp.inf), initial=-jnp.inf)
    near, span = jnp.where(inside.any(), near, 0), jnp.where(inside.any(), far - near, 1)
    step = jnp.maximum(span, 1e-3) / (_BINS - 1)
    slice_ = jnp.clip((jnp.where(inside, depth, near) - near) / step, 0, _BINS - 1).astype(jnp.int32)
    key = jnp.where(inside, _key(jnp.where(inside[:, None], cell, 0), slice_), _NOWHERE)
    index = jnp.arange(points.shape[0], dtype=jnp.int32)
    key, order = jax.lax.sort((key, index), num_keys=1, is_stable=True)
    return Cells(key, points[order].T, lower, size, near, step)


def _cell(uv: Float[Array, "*n 2"], lower: Float[Array, "2"], size: Float[Array, ""]) -> Int[Array, "*n 2"]:
    """Row and column of the cell; far points and NaNs go to -1."""
    place = jnp.floor((uv - lower) / size)
    return jnp.where((place >= 0) & (place < _CELLS), place, -1).astype(jnp.int32)


def _key(cell: Int[Array, "*n 2"], depth: Int[Array, "*n"]) -> UInt[Array, "*n"]:
    row, column = cell[..., 0].astype(jnp.uint32), cell[..., 1].astype(jnp.uint32)
    return (row * _CELLS + column) * _BINS + depth.astype(jnp.uint32)
