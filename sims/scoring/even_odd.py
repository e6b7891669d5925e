"""Which points of the canvas are inked by filled areas: the even-odd rule, exact at every ring."""

from collections.abc import Iterator, Sequence

import cv2
import numpy as np
from jaxtyping import Bool, Float

from sims.scoring.lines import densify

Ring = Float[np.ndarray, "points 2"]

_PIXEL = 0.0005  # of the picture that answers away from the rings [m]
_SUBPIXEL = 6  # fractional bits of cv2's drawing
_NEAR = 2  # pixels about a ring within which the ring itself answers
_PAIRS = 4_000_000  # of edges and points that are compared at once
_PROBE = 0.0002  # to either side of a ring, to see whether ink ends there [m]


class FilledAreas:
    """Areas on the canvas [m], each a set of closed rings under the even-odd rule; together they are the ink.

    A picture of half millimetres answers for points away from all rings, the rings themselves for the others.
    """

    def __init__(self, areas: Sequence[Sequence[Ring]]):
        self.areas = tuple(tuple(_closed(ring) for ring in rings if len(ring) > 2) for rings in areas)
        self.rings = tuple(ring for rings in self.areas for ring in rings)
        points = np.concatenate(self.rings) if self.rings else np.zeros((1, 2))
        border = (_NEAR + 2) * _PIXEL
        self._corner = points.min(axis=0) - border
        columns, rows = np.ceil((points.max(axis=0) + border - self._corner) / _PIXEL).astype(int) + 1
        self._ink = np.zeros((rows, columns), np.uint8)
        self._edge = np.zeros((rows, columns), np.uint8)
        for rings in self.areas:
            self._draw(rings)
        grown = cv2.dilate(self._edge, np.ones((2 * _NEAR + 1, 2 * _NEAR + 1), np.uint8))
        self._edge = np.asarray(grown, np.uint8)

    def contains(self, points: Float[np.ndarray, "points 2"]) -> Bool[np.ndarray, "points"]:
        """Whether each point [m] is inked; NaN is not."""
        place = np.nan_to_num((points - self._corner) / _PIXEL, nan=-1, posinf=-1, neginf=-1)
        size = np.asarray(self._ink.shape[::-1])
        held = ((place >= 0) & (place <= size - 1)).all(axis=1)
        column, row = np.rint(np.where(held[:, None], place, 0)).astype(int).T
        near = held & (self._edge[row, column] > 0)
        inked = held & ~near & (self._ink[row, column] > 0)
        inked[near] = self._by_rings(points[near])
        return inked

    def edges(self, step: float) -> Iterator[tuple[Ring, Bool[np.ndarray, "points"]]]:
        """Each ring at even steps [m], and where ink ends there: not where two areas of the ink touch."""
        dense = [densify(ring, step) for ring in self.rings]
        if not dense:
            return
        sides = [_either_side(ring) for ring in dense]
        left, right = (self.contains(np.concatenate([side[k] for side in sides])) for k in (0, 1))
        cuts = np.cumsum([len(ring) for ring in dense])[:-1]
        yield from zip(dense, np.split(left != right, cuts), strict=True)

    def _draw(self, rings: Sequence[Ring]) -> None:
        """Adds one area; cv2 fills all contours of one call by the even-odd rule."""
        if not rings:
            return
        points = (np.concatenate(rings) - self._corner) / _PIXEL
        low, high = np.floor(points.min(axis=0)).astype(int) - 1, np.ceil(points.max(axis=0)).astype(int) + 2
        window = np.s_[low[1] : high[1], low[0] : high[0]]
        fixed = [
            np.rint(((ring - self._corner) / _PIXEL - low) * 2**_SUBPIXEL).astype(np.int32) for ring in rings
        ]
        part = np.zeros((high - low)[::-1], np.uint8)
        self._ink[window] |= np.asarray(cv2.fillPoly(part, fixed, 1, shift=_SUBPIXEL), np.uint8)
        part = np.zeros((high - low)[::-1], np.uint8)
        outlines = cv2.polylines(part, fixed, isClosed=True, color=1, shift=_SUBPIXEL)
        self._edge[window] |= np.asarray(outlines, np.uint8)

    def _by_rings(self, points: Float[np.ndarray, "points 2"]) -> Bool[np.ndarray, "points"]:
        inked = np.zeros(len(points), bool)
        for rings in self.areas:
            if not rings:
                continue
            corners = np.concatenate(rings)
            there = ((points >= corners.min(axis=0)) & (points <= corners.max(axis=0))).all(axis=1)
            index = np.flatnonzero(there & ~inked)
            inked[index] = even_odd(rings, points[index])
        return inked


def even_odd(rings: Sequence[Ring], points: Float[np.ndarray, "points 2"]) -> Bool[np.ndarray, "points"]:
    """Whether an odd number of edges lies to the right of each point; no pictures, no tolerance."""
    start, end = (np.concatenate([ring[part] for ring in rings]) for part in (np.s_[:-1], np.s_[1:]))
    order = np.argsort(points[:, 1], kind="stable")
    across, height = points[order].T
    low, high = np.minimum(start[:, 1], end[:, 1]), np.maximum(start[:, 1], end[:, 1])
    first, last = np.searchsorted(height, low), np.searchsorted(height, high)
    crossings = np.zeros(len(points), int)
    for edges in _blocks(last - first):
        count = (last - first)[edges]
        edge = np.repeat(edges, count)
        point = np.arange(len(edge)) + np.repeat(first[edges] - np.cumsum(count) + count, count)
        share = (height[point] - start[edge, 1]) / (end[edge, 1] - start[edge, 1])
        right = start[edge, 0] + share * (end[edge, 0] - start[edge, 0]) > across[point]
        crossings += np.bincount(point[right], minlength=len(points))
    odd = np.empty(len(points), bool)
    odd[order] = crossings % 2 == 1
    return odd


def _blocks(counts: np.ndarray) -> Iterator[np.ndarray]:
    """Indices of the edges that meet any point, in blocks of bounded work."""
    some = np.flatnonzero(counts)
    block = np.cumsum(counts[some]) // _PAIRS
    return iter(np.split(some, np.flatnonzero(np.diff(block)) + 1)) if len(some) else iter(())


def _closed(ring: Ring) -> Ring:
    ring = np.asarray(ring, float)
    return ring if (ring[0] == ring[-1]).all() else np.concatenate([ring, ring[:1]])


def _either_side(ring: Ring) -> tuple[np.ndarray, np.ndarray]:
    """Points a little to the left and to the right of each point of a dense ring."""
    along = np.roll(ring[:-1], -1, axis=0) - np.roll(ring[:-1], 1, axis=0)
    along = np.concatenate([along, along[:1]])
    length = np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-12)
    across = _PROBE * np.stack([-along[:, 1], along[:, 0]], axis=1) / length
    return ring + across, ring - across
