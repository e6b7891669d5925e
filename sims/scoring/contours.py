"""Where a film ends: its contour at a level, to a fraction of a cell (marching squares)."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

# The edges of a square of four cells, from corner to corner: (row, column) offsets, counter-clockwise.
_CORNERS = np.array([(0, 0), (0, 1), (1, 1), (1, 0)])


class Contour(NamedTuple):
    """Short straight pieces of a contour: their middles as (column, row) in cells, and their lengths."""

    middle: Float[np.ndarray, "pieces 2"]
    length: Float[np.ndarray, "pieces"]


def contour(film: Float[np.ndarray, "rows columns"], level: float) -> Contour:
    """Where a film, bilinear between the middles of cells, passes a level; the border is no contour.

    Where a square has two opposite corners above the level, its mean decides which are joined.
    """
    above = film >= level
    sides = above[:-1, :-1].astype(np.int8) + above[:-1, 1:] + above[1:, 1:] + above[1:, :-1]
    row, column = np.nonzero((sides > 0) & (sides < 4))
    corner = np.stack([film[row + r, column + c] for r, c in _CORNERS], axis=1).astype(float)
    following = np.roll(corner, -1, axis=1)
    crossed = (corner >= level) != (following >= level)
    gap = np.where(crossed, following - corner, 1)
    share = ((level - corner) / gap)[..., None]
    step = np.roll(_CORNERS, -1, axis=0) - _CORNERS
    # (row, column) at which the contour passes each edge of each square.
    passed = np.stack([row, column], axis=-1)[:, None] + _CORNERS + share * step
    start, end = _joined(corner, crossed, passed, level)
    middle = 0.5 * (start + end)
    return Contour(middle[:, ::-1], np.linalg.norm(end - start, axis=1))


def _joined(
    corner: np.ndarray, crossed: np.ndarray, passed: np.ndarray, level: float
) -> tuple[np.ndarray, np.ndarray]:
    """Both ends of each piece: one piece in most squares, two in a saddle."""
    each = np.arange(len(crossed))
    saddle = crossed.all(axis=1)
    first, last = crossed.argmax(axis=1), 3 - crossed[:, ::-1].argmax(axis=1)
    # In a saddle edge k parts corner k from corner k + 1: corner 0 is cut off by edges 3 and 0, or joined to
    # corner 2 past edges 0, 1 and 2, 3.
    together = (corner.mean(axis=1) >= level) == (corner[:, 0] >= level)
    last = np.where(saddle & together, 1, last)
    second = each[saddle]
    from_, to = np.where(together, 2, 1)[second], np.where(together, 3, 2)[second]
    start = np.concatenate([passed[each, first], passed[second, from_]])
    return start, np.concatenate([passed[each, last], passed[second, to]])
