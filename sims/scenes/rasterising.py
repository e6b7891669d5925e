"""The front-most surface of triangles on a lattice: a z-buffer in numpy."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Float, Int

from sims.scenes.gridding import Lattice

_PAIRS = 4_000_000
# Cell middles this near to an edge, in parts of the triangle, belong to both its sides: no cracks.
_EDGE = 1e-9


def rasterise(
    corners: Float[np.ndarray, "F 3 3"], lattice: Lattice, front: float
) -> tuple[Float[np.ndarray, "V U"], Int[np.ndarray, "V U"]]:
    """Depth x of what a ray along +x from x = front meets first at the middle of each cell, and whose it is.

    corners: of each triangle, in wall axes [m]. Returns depths [m], inf where nothing is met, and indices of
    triangles, -1 there. Exact at the middles; triangles seen edge-on are met by nothing.
    """
    rows, columns = lattice.shape
    column = (-corners[:, :, 1] - lattice.left) / lattice.cell
    row = (corners[:, :, 2] - lattice.low) / lattice.cell
    depth = np.full(rows * columns, np.inf)
    owner = np.full(rows * columns, -1)
    for triangle, cell in _candidates(column, row, lattice.shape):
        x = _depth_at(
            column[triangle], row[triangle], corners[triangle, :, 0], cell % columns, cell // columns
        )
        keep = np.isfinite(x) & (x >= front)
        triangle, cell, x = triangle[keep], cell[keep], x[keep]
        np.minimum.at(depth, cell, x)
        won = depth[cell] == x
        owner[cell[won]] = triangle[won]
    return depth.reshape(rows, columns), owner.reshape(rows, columns)


def _candidates(
    column: Float[np.ndarray, "F 3"], row: Float[np.ndarray, "F 3"], shape: tuple[int, int]
) -> Iterator[tuple[Int[np.ndarray, "P"], Int[np.ndarray, "P"]]]:
    """Triangles and the cells in the rectangles around them, as pairs, some millions at a time."""
    low = np.maximum(np.ceil(np.stack([row.min(axis=1), column.min(axis=1)], axis=1) - 1e-6), 0).astype(int)
    high = np.floor(np.stack([row.max(axis=1), column.max(axis=1)], axis=1) + 1e-6).astype(int)
    size = np.maximum(np.minimum(high, np.array(shape) - 1) - low + 1, 0)
    count = size.prod(axis=1)
    share = np.cumsum(count) // _PAIRS
    filled = np.flatnonzero(count)
    for group in np.split(filled, np.flatnonzero(np.diff(share[filled])) + 1):
        triangle = np.repeat(group, count[group])
        start = np.cumsum(count[group]) - count[group]
        within = np.arange(len(triangle)) - np.repeat(start, count[group])
        wide = size[triangle, 1]
        yield triangle, (low[triangle, 0] + within // wide) * shape[1] + low[triangle, 1] + within % wide


def _depth_at(
    column: Float[np.ndarray, "P 3"],
    row: Float[np.ndarray, "P 3"],
    x: Float[np.ndarray, "P 3"],
    at_column: Int[np.ndarray, "P"],
    at_row: Int[np.ndarray, "P"],
) -> Float[np.ndarray, "P"]:
    """Depth of triangles at points of the lattice [m], inf outside of them."""
    across, up = column - at_column[:, None], row - at_row[:, None]
    # Twice the areas that the point makes with each side, opposite to corners 0, 1 and 2.
    parts = np.stack(
        [across[:, i] * up[:, j] - across[:, j] * up[:, i] for i, j in ((1, 2), (2, 0), (0, 1))], axis=1
    )
    total = parts.sum(axis=1)
    seen = np.abs(total) > 1e-12
    weights = parts / np.where(seen, total, 1.0)[:, None]
    inside = seen & (weights >= -_EDGE).all(axis=1)
    return np.where(inside, np.sum(weights * x, axis=1), np.inf)
