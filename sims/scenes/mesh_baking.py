"""A mesh as one fast surface: a height map that goes through it, and where there is none.

Nothing is smoothed: between the middles of the cells, where it is exact, the surface is the quadratic spline
through them, each smooth part of the mesh on its own.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy import ndimage
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from jaxpaint.errors import InputError
from sims.scenes.gridding import Lattice
from sims.scenes.rasterising import rasterise

# What is steeper against the wall is not on the surface.
STEEPEST = np.deg2rad(70.0)
_MIN_CELL, _MAX_CELLS = 0.0015, 220_000
_STEP, _STEP_CELLS = 0.001, 0.3
_MIN_REGION_CELLS = 12
# What is further behind the wall is seen through its holes, and no part of it.
_BEHIND = 0.5
_REACH = 6
_ROUGH_WINDOW = 0.02


@dataclass(frozen=True)
class MeshSurface:
    """The surface on its lattice, x into the wall.

    samples: depth at the middles of the cells, finite everywhere [m]. coefficients: of the spline through
    them. valid: where the surface can be painted and seen. wall: valid cells of the wall itself. empty: cells
    where nothing is. slopes: of the mesh by u and v. residuals: rms, 95th percentile and maximum distance of
    mesh and surface, between the middles of the cells and away from rims [m]. roughness: rms height of the
    wall over its mean within 2 cm [m].
    """

    lattice: Lattice
    samples: Float[np.ndarray, "V U"]
    coefficients: Float[np.ndarray, "V U"]
    valid: Bool[np.ndarray, "V U"]
    wall: Bool[np.ndarray, "V U"]
    empty: Bool[np.ndarray, "V U"]
    slopes: Float[np.ndarray, "2 V U"]
    residuals: tuple[float, float, float]
    roughness: float


def bake_mesh(
    corners: Float[np.ndarray, "F 3 3"],
    front: float,
    name: str,
    window: tuple[Float[np.ndarray, "2"], Float[np.ndarray, "2"]] | None = None,
) -> MeshSurface:
    """What the robot sees of triangles in wall axes, the wall seen from x < 0.

    front: x before which nothing counts [m]. window: lowest and highest (u, v) to bake [m]; None: all.
    Raises InputError where no part is smooth enough to be a wall.
    """
    lattice = _lattice(corners, front, window)
    depth, owner = rasterise(corners, lattice, front)
    slopes = _slopes(corners, owner)
    label = _regions(depth, slopes, lattice.cell)
    wall, label = _wall_label(label, depth, name)
    empty = ~np.isfinite(depth) | ((label == 0) & (depth > np.median(depth[label == wall]) + _BEHIND))
    label[empty] = 0
    steep = np.hypot(*slopes) > np.tan(STEEPEST)
    valid = (label > 0) & ~steep & _alone(np.where(empty, -1, label))
    samples, coefficients = _interpolated(np.where(empty, np.nan, depth), label, slopes, lattice.cell)
    on_wall = valid & (label == wall)
    residuals = _residuals(corners, lattice, front, coefficients, on_wall)
    rough = _roughness(samples, on_wall, lattice.cell)
    return MeshSurface(lattice, samples, coefficients, valid, on_wall, empty, slopes, residuals, rough)


def _lattice(corners: np.ndarray, front: float, window: tuple[np.ndarray, np.ndarray] | None) -> Lattice:
    shown = corners[(corners[:, :, 0] >= front).any(axis=1)]
    uv = np.stack([-shown[:, :, 1], shown[:, :, 2]], axis=-1).reshape(-1, 2)
    low, high = uv.min(axis=0), uv.max(axis=0)
    if window is not None:
        low, high = np.maximum(low, window[0]), np.minimum(high, window[1])
    extent = np.maximum(high - low, 1e-3)
    cell = max(_MIN_CELL, float(np.sqrt(extent.prod() / _MAX_CELLS)))
    # Half a cell off, so that edges of sheets do not fall on the middles of cells.
    columns, rows = (np.ceil(extent / cell).astype(int) + 4).tolist()
    left, bottom = low - 1.5 * cell - 0.5 * (np.ceil(extent / cell) * cell - extent)
    return Lattice(float(left), float(bottom), cell, (rows, columns))


def _slopes(corners: np.ndarray, owner: Int[np.ndarray, "V U"]) -> Float[np.ndarray, "2 V U"]:
    """Slopes of the mesh by u = -y and v = z at every cell, 0 where nothing is."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    x = np.where(np.abs(normals[:, 0]) > 0, normals[:, 0], 1.0)
    slopes = np.stack([normals[:, 1] / x, -normals[:, 2] / x])
    return np.where(owner >= 0, slopes[:, np.maximum(owner, 0)], 0.0)


def _regions(depth: np.ndarray, slopes: np.ndarray, cell: float) -> Int[np.ndarray, "V U"]:
    """Labels 1, 2, ... of the parts that hang together without a step, by falling size; 0 for scraps."""
    number = np.arange(depth.size).reshape(depth.shape)
    run = np.clip(slopes, -np.tan(STEEPEST), np.tan(STEEPEST)) * cell
    ends = []
    for axis, slope in ((1, run[0]), (0, run[1])):
        here, there = (slice(None),) * axis + (slice(1, None),), (slice(None),) * axis + (slice(None, -1),)
        with np.errstate(invalid="ignore"):
            rise = depth[here] - depth[there]
        # A kink between two middles lets the rise be anything between what the two slopes make of it.
        low, high = np.minimum(slope[here], slope[there]), np.maximum(slope[here], slope[there])
        slack = max(_STEP, _STEP_CELLS * cell)
        joined = np.isfinite(rise) & (rise > low - slack) & (rise < high + slack)
        ends.append(np.stack([number[here][joined], number[there][joined]]))
    rows, columns = np.concatenate(ends, axis=1)
    graph = coo_array((np.ones(len(rows), dtype=bool), (rows, columns)), shape=(depth.size, depth.size))
    found = connected_components(graph, directed=False)[1].reshape(depth.shape)
    sizes = np.bincount(found[np.isfinite(depth)], minlength=found.max() + 1)
    order = np.argsort(-sizes, kind="stable")
    rank = np.zeros(len(sizes), dtype=int)
    kept = order[sizes[order] >= _MIN_REGION_CELLS]
    rank[kept] = np.arange(1, len(kept) + 1)
    return np.where(np.isfinite(depth), rank[found], 0)


def _wall_label(label: np.ndarray, depth: np.ndarray, name: str) -> tuple[int, Int[np.ndarray, "V U"]]:
    """The largest part, and the labels without those that lie so far behind it that it is another wall."""
    if not label.any():
        raise InputError(f"{name}: no part of the mesh is smooth enough to be a wall")
    limit = np.median(depth[label == 1]) + _BEHIND
    part = ndimage.median(np.where(np.isfinite(depth), depth, 0.0), label, np.arange(label.max() + 1))
    far = np.asarray(part) > limit
    far[:2] = False
    return 1, np.where(far[label], 0, label)


def _alone(label: Int[np.ndarray, "V U"]) -> Bool[np.ndarray, "V U"]:
    """Cells that have no neighbour in another part; empty neighbours (-1) do not count."""
    own = np.where(label < 0, label.max() + 1, label)
    return ndimage.maximum_filter(label, 3) == ndimage.minimum_filter(own, 3)


def _interpolated(
    depth: np.ndarray, label: np.ndarray, slopes: np.ndarray, cell: float
) -> tuple[Float[np.ndarray, "V U"], Float[np.ndarray, "V U"]]:
    """Depths everywhere, and the coefficients of the splines through each part on its own.

    A part is continued over its rim along its slopes, so that the spline does not ring there.
    """
    nearest = ndimage.distance_transform_edt(np.isnan(depth), return_distances=False, return_indices=True)
    samples = depth[tuple(nearest)]
    coefficients, taken = samples.copy(), np.full(depth.shape, np.inf)
    for number, window in enumerate(ndimage.find_objects(label), start=1):
        if window is None:
            continue
        window = tuple(slice(max(side.start - _REACH, 0), side.stop + _REACH) for side in window)
        mine = label[window] == number
        distance, at = ndimage.distance_transform_edt(~mine, return_indices=True)
        rows, columns = np.indices(mine.shape)
        steep = np.tan(STEEPEST)
        across, up = (np.clip(slopes[axis][window], -steep, steep)[tuple(at)] for axis in (0, 1))
        ahead = np.minimum(1.0, _REACH / np.maximum(distance, 1e-9)) * cell
        continued = samples[window][tuple(at)] + ahead * (across * (columns - at[1]) + up * (rows - at[0]))
        spline = np.asarray(ndimage.spline_filter(continued, order=2, mode="mirror"))
        closer = (distance < taken[window]) & (distance < 3) & (mine | (label[window] == 0))
        coefficients[window][closer] = spline[closer]
        taken[window][closer] = distance[closer]
    return samples, coefficients


def _residuals(
    corners: np.ndarray, lattice: Lattice, front: float, coefficients: np.ndarray, wall: np.ndarray
) -> tuple[float, float, float]:
    """Distances at the corners of the cells, farthest from where the surface was made to fit [m]."""
    half = 0.5 * lattice.cell
    moved = Lattice(lattice.left + half, lattice.low + half, lattice.cell, lattice.shape)
    depth, owner = rasterise(corners, moved, front)
    slope = np.hypot(*_slopes(corners, owner))
    inner = ndimage.binary_erosion(wall, np.ones((3, 3)))
    known = inner & np.roll(inner, -1, axis=0) & np.roll(inner, -1, axis=1) & np.roll(inner, (-1, -1), (0, 1))
    rows, columns = np.nonzero(known & np.isfinite(depth))
    found = ndimage.map_coordinates(
        coefficients, [rows + 0.5, columns + 0.5], order=2, prefilter=False, mode="nearest"
    )
    gap = np.abs(found - depth[rows, columns]) / np.hypot(1.0, slope[rows, columns])
    if not gap.size:
        return 0.0, 0.0, 0.0
    return float(np.sqrt(np.mean(gap**2))), float(np.percentile(gap, 95)), float(gap.max())


def smoothed(values: Float[np.ndarray, "V U"], where: Bool[np.ndarray, "V U"], width: float) -> np.ndarray:
    """Gaussian means over cells of a mask, `width` in cells; the values themselves far from it."""
    weight = ndimage.gaussian_filter(where.astype(float), width, mode="constant", truncate=2.5)
    total = ndimage.gaussian_filter(np.where(where, values, 0.0), width, mode="constant", truncate=2.5)
    return np.where(weight > 1e-6, total / np.maximum(weight, 1e-6), values)


def _roughness(samples: np.ndarray, wall: np.ndarray, cell: float) -> float:
    """From a difference of two windows, which leaves out the shape: means over 2 cm lie on bends, too."""
    width = _ROUGH_WINDOW / cell
    inner = ndimage.binary_erosion(wall, np.ones((3, 3)), iterations=max(1, int(2.5 * width)))
    once = smoothed(samples, wall, width)
    # On the flanks of a column a mean within 2 cm bends too much to tell.
    inner &= np.hypot(*np.gradient(once, cell)) < 1.0
    bend = once - smoothed(once, wall, width)
    gap = (samples - once - bend)[inner]
    return float(np.sqrt(np.mean(gap**2))) if gap.size else 0.0
