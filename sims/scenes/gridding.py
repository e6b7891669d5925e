"""From the points in front of the robot to a grid of depths: the front-most surface, cut where it jumps."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy import ndimage
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

# A surface steeper than this against the wall is seen too obliquely to be painted or trusted.
MAX_SLOPE = np.tan(np.deg2rad(40.0))
_MIN_REGION_CELLS = 12


@dataclass(frozen=True)
class Lattice:
    """The cells of a wall: rows go up, columns to the robot's right, (left, low) the middle of cell (0, 0).

    left: u = -y of the first column [m]. low: z of the first row [m]. cell: pitch [m]. shape: rows, columns.
    """

    left: float
    low: float
    cell: float
    shape: tuple[int, int]

    @staticmethod
    def around(points: Float[np.ndarray, "N 3"], cell: float) -> "Lattice":
        """The lattice over the middle 99.9 % of the points, one cell of margin around."""
        low, high = np.percentile(np.stack([-points[:, 1], points[:, 2]], axis=1), [0.05, 99.95], axis=0)
        columns, rows = (np.ceil((high - low) / cell).astype(int) + 3).tolist()
        return Lattice(float(low[0] - cell), float(low[1] - cell), cell, (rows, columns))

    def index(self, points: Float[np.ndarray, "N 3"]) -> tuple[Int[np.ndarray, "N"], Bool[np.ndarray, "N"]]:
        """Flat index of each point's cell, and whether it lies on the lattice at all."""
        column = np.round((-points[:, 1] - self.left) / self.cell).astype(int)
        row = np.round((points[:, 2] - self.low) / self.cell).astype(int)
        inside = (row >= 0) & (row < self.shape[0]) & (column >= 0) & (column < self.shape[1])
        return np.where(inside, row * self.shape[1] + column, 0), inside


@dataclass(frozen=True)
class FrontSurface:
    """Front-most points by cell: how many, their mean depth x [m], and the smooth region a cell belongs to.

    region: 0 where nothing was captured or the surface is too steep, else 1, 2, ... by falling size.
    used: which of the given points make it up.
    """

    count: Float[np.ndarray, "V U"]
    depth: Float[np.ndarray, "V U"]
    region: Int[np.ndarray, "V U"]
    used: Bool[np.ndarray, "N"]


def front_surface(points: Float[np.ndarray, "N 3"], lattice: Lattice, noise: float) -> FrontSurface:
    """Keeps of every cell what the robot sees first, stray points aside, and splits it into smooth regions.

    noise: spread of the capture about local planes [m]; steps above five times that, and above what the
    steepest allowed slope makes over the cells compared, are edges.
    """
    index, inside = lattice.index(points)
    start = _front_bins(points[inside], index[inside], lattice, noise)
    slab = max(0.03, 5 * noise) + MAX_SLOPE * lattice.cell
    used = inside & (points[:, 0] >= start.ravel()[index]) & (points[:, 0] <= start.ravel()[index] + slab)
    cells = lattice.shape[0] * lattice.shape[1]
    count = np.bincount(index[used], minlength=cells).astype(float)
    total = np.bincount(index[used], points[used, 0], minlength=cells)
    depth = np.where(count > 0, total / np.maximum(count, 1), np.nan).reshape(lattice.shape)
    edge = max(5 * noise, 2 * lattice.cell * MAX_SLOPE)
    return FrontSurface(count.reshape(lattice.shape), depth, _regions(depth, edge), used)


def _front_bins(
    points: Float[np.ndarray, "N 3"], index: Int[np.ndarray, "N"], lattice: Lattice, noise: float
) -> Float[np.ndarray, "V U"]:
    """Depth at which each cell's first well supported layer begins; +inf for an empty cell.

    A layer counts when it holds a fifth of the points that a cell's surroundings usually hold: what is
    thinner are the flying points that sensors leave between an object and what is behind it.
    """
    height = max(0.02, 3 * noise)
    first = float(points[:, 0].min())
    layer = ((points[:, 0] - first) / height).astype(int)
    layers = int(layer.max()) + 2
    counts = np.zeros((layers, *lattice.shape), dtype=np.float32)
    np.add.at(counts.reshape(layers, -1), (layer, index), 1.0)
    support = ndimage.uniform_filter(counts, size=(1, 3, 3), mode="constant") * 9
    support[:-1] += support[1:].copy()
    filled = counts.sum(axis=0) > 0
    enough = max(3.0, 0.2 * float(np.median(support.max(axis=0)[filled])))
    mine = (counts > 0) & (support >= enough)
    return np.where(mine.any(axis=0), first + height * mine.argmax(axis=0), np.inf)


def _regions(depth: Float[np.ndarray, "V U"], edge: float) -> Int[np.ndarray, "V U"]:
    """Labels of connected cells without a step above `edge` between them."""
    smooth = _median3(depth)
    filled = np.isfinite(smooth)
    span = _span3(smooth)
    calm = filled & (span < edge)
    labels = _connect(smooth, calm, edge / 2)
    labels = _adopt(labels, smooth, np.isfinite(depth) & ~calm, edge)
    sizes = np.bincount(labels.ravel())
    sizes[0] = 0
    order = np.argsort(-sizes, kind="stable")
    rank = np.zeros(len(sizes), dtype=int)
    kept = order[sizes[order] >= _MIN_REGION_CELLS]
    rank[kept] = np.arange(1, len(kept) + 1)
    return rank[labels]


def _median3(depth: np.ndarray) -> np.ndarray:
    """Median of each cell's finite 3 x 3 neighbours, for cells that hold something themselves."""
    padded = np.pad(depth, 1, constant_values=np.nan)
    windows = np.lib.stride_tricks.sliding_window_view(padded, (3, 3)).reshape(*depth.shape, 9)
    ordered = np.sort(windows, axis=-1)
    finite = np.isfinite(windows).sum(axis=-1)
    middle = np.take_along_axis(ordered, np.maximum(finite[..., None] - 1, 0) // 2, axis=-1)[..., 0]
    return np.where(np.isfinite(depth), middle, np.nan)


def _span3(depth: np.ndarray) -> np.ndarray:
    filled = np.isfinite(depth)
    high = ndimage.maximum_filter(np.where(filled, depth, -np.inf), 3, mode="nearest")
    low = ndimage.minimum_filter(np.where(filled, depth, np.inf), 3, mode="nearest")
    return np.where(filled, high - low, np.inf)


def _connect(depth: np.ndarray, calm: np.ndarray, step: float) -> np.ndarray:
    """Connected components of calm cells, neighbours joined where they differ by less than `step`."""
    number = np.arange(depth.size).reshape(depth.shape)
    ends = []
    for here, there in (
        ((slice(1, None), slice(None)), (slice(None, -1), slice(None))),
        ((slice(None), slice(1, None)), (slice(None), slice(None, -1))),
    ):
        joined = calm[here] & calm[there] & (np.abs(depth[here] - depth[there]) < step)
        ends.append(np.stack([number[here][joined], number[there][joined]]))
    rows, columns = np.concatenate(ends, axis=1)
    graph = coo_array((np.ones(len(rows)), (rows, columns)), shape=(depth.size, depth.size))
    _, labels = connected_components(graph, directed=False)
    return np.where(calm, labels.reshape(depth.shape) + 1, 0)


def _adopt(labels: np.ndarray, depth: np.ndarray, orphans: np.ndarray, edge: float) -> np.ndarray:
    """Gives edge cells to the neighbouring region whose depth is nearest, two rings deep."""
    labels = labels.copy()
    known = np.where(labels > 0, depth, np.nan)
    for _ in range(2):
        best = np.full(depth.shape, edge / 2)
        chosen = np.zeros_like(labels)
        for shift in ((0, 1), (0, -1), (1, 0), (-1, 0)):
            gap = np.abs(depth - _shift(known, shift, np.nan))
            closer = gap < best
            best = np.where(closer, gap, best)
            chosen = np.where(closer, _shift(labels, shift, 0), chosen)
        taken = orphans & (labels == 0) & (chosen > 0)
        labels = np.where(taken, chosen, labels)
        known = np.where(taken, depth, known)
    return labels


def _shift(array: np.ndarray, by: tuple[int, int], fill: float) -> np.ndarray:
    """The array moved by one cell without wrapping round."""
    padded = np.pad(array, 1, constant_values=fill)
    return padded[1 - by[0] : 1 - by[0] + array.shape[0], 1 - by[1] : 1 - by[1] + array.shape[1]]
