"""The nearest neighbours of every point of a cloud, and work over them in pieces that a cache holds."""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Self

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import cKDTree

from jaxpaint.refinement.checking import checked_cloud, require_above

_QUERIES = 65_536
"""Points asked for at once: scipy answers in 16 bytes a neighbour, four times what is kept."""
_ELEMENTS = 131_072
"""Neighbours worked on at once."""


@dataclass(frozen=True)
class Neighbourhoods:
    """A cloud about its mean, and for every point the indices of its nearest, itself among them.

    points: a column a point, so that sums over neighbours run through memory in order [m]. mean: what was
    taken away, in doubles [m]: far from the origin single precision has no millimetres left. Four bytes are
    kept a neighbour: 3.8 GB for five million points with 192.
    """

    points: Float[np.ndarray, "3 N"]
    index: Int[np.ndarray, "N k"]
    mean: Float[np.ndarray, "3"]

    @classmethod
    def of(cls, points: Float[np.ndarray, "N 3"], neighbours: int) -> Self:
        """So many nearest of every point, all points where there are fewer. Raises ValueError."""
        points = checked_cloud(points)
        require_above(2, neighbours=neighbours)
        mean = points.mean(axis=0, dtype=np.float64)
        centred = points - mean
        k = min(neighbours, len(points))
        tree = cKDTree(centred)
        index = np.empty((len(points), k), np.int32)
        for start in range(0, len(points), _QUERIES):
            piece = slice(start, start + _QUERIES)
            index[piece] = tree.query(centred[piece], k=k, workers=-1)[1]
        return cls(np.ascontiguousarray(centred.T, dtype=points.dtype), index, mean)

    @property
    def k(self) -> int:
        """How many neighbours each point has, itself included."""
        return self.index.shape[1]

    def nearest(self, neighbours: int) -> Self:
        """The same with the nearest `neighbours` only."""
        return type(self)(self.points, self.index[:, :neighbours], self.mean)

    def around(
        self, rows: slice, points: Float[np.ndarray, "3 N"] | None = None
    ) -> Float[np.ndarray, "3 n k"]:
        """Neighbours relative to their point [m]: as they came, or as `points` have them now."""
        points = self.points if points is None else points
        return np.stack([axis[self.index[rows]] - axis[rows, None] for axis in points])

    def each(self, work: Callable[[slice], Float[np.ndarray, "*rest n"]]) -> Float[np.ndarray, "*rest N"]:
        """What `work` makes of pieces of the cloud, side by side. On threads: numpy lets others run."""
        rows = max(_ELEMENTS // self.k, 1)
        pieces = [slice(start, start + rows) for start in range(0, len(self.index), rows)]
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            return np.concatenate(list(pool.map(work, pieces)), axis=-1)

    def placed(self, points: Float[np.ndarray, "3 N"]) -> Float[np.ndarray, "N 3"]:
        """Points about the mean back where the cloud came from, in the cloud's own type."""
        return (points.T + self.mean).astype(self.points.dtype)
