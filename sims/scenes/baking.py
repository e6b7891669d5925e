"""A captured wall as one smooth surface: the truth of the simulations that use it."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy import ndimage
from scipy.spatial import cKDTree

from jaxpaint.errors import InputError
from sims.scenes.gridding import FrontSurface, Lattice, front_surface
from sims.scenes.smoothing import fit_regions, fit_sheet

_MIN_CELL, _MAX_CELL, _MAX_CELLS = 0.009, 0.10, 200_000
_WALL_BAND = 0.08
_MIN_SPAN = 4
# White noise in the normals halves from one window to the next, shape does not.
_CALM, _NOISY, _FALLS = np.deg2rad(0.25), np.deg2rad(1.0), 0.8
# A window that leaves twice what the narrowest one leaves smooths shape away.
_LOOSE = 2.0
_MAX_WIDTH = 0.25
_SMALL_HOLE = 0.025
_STRAY = 4.7


@dataclass(frozen=True)
class Baked:
    """The surface on its lattice.

    depth: x of the surface, finite everywhere [m]. valid: where it was captured. wall: valid cells of the
    wall itself, objects aside. width: standard deviation of the smoothing window on the wall [m]. jitter:
    rms angle between the wall's normals and those of windows 1.4 times as wide [rad]. noise: rms of the
    wall's points about planes in such windows [m]. residuals: rms and 95th percentile of the wall's points
    from the surface, then rms over everything valid [m]. used: which points the surface was made from; the
    others are hidden, stray or steep.
    """

    lattice: Lattice
    depth: Float[np.ndarray, "V U"]
    valid: Bool[np.ndarray, "V U"]
    wall: Bool[np.ndarray, "V U"]
    width: float
    jitter: float
    noise: float
    residuals: tuple[float, float, float]
    used: Bool[np.ndarray, "N"]


def bake(points: Float[np.ndarray, "N 3"], name: str) -> Baked:
    """The front-most surface of points in wall axes (the wall near x = 0, seen from x < 0), made smooth.

    The window widens until the wall's normals no longer change with it: a sensor's noise is gone then, and
    what remains is the shape. Where the wide window does not describe the points, as on objects, narrower
    ones do.
    """
    cell, local_noise = _pitch_and_noise(points, name)
    lattice = Lattice.around(points, cell)
    front = front_surface(points, lattice, local_noise)
    label = _wall_label(front, name)
    at = lattice.index(points)[0]
    wall_points = points[front.used & (front.region == label).ravel()[at]]
    window = _choose_window(front, wall_points, lattice, label, local_noise)
    labels = _close_small_holes(front, cell)
    reach = _extended(labels)
    depth = fit_regions(front, reach, cell, window.width, window.spread)
    valid = (labels > 0) & _alone(reach) & _explained(front, depth, window.noise)
    wall = valid & (labels == label)
    residual = _residuals(points, lattice, depth)
    used = front.used & valid.ravel()[at] & (np.abs(residual) < _STRAY * window.noise)
    on_wall = residual[used & wall.ravel()[at]]
    figures = (_rms(on_wall), float(np.percentile(np.abs(on_wall), 95)), _rms(residual[used]))
    return Baked(lattice, depth, valid, wall, window.width, window.jitter, window.noise, figures, used)


def _pitch_and_noise(points: Float[np.ndarray, "N 3"], name: str) -> tuple[float, float]:
    """Pitch of the cells, about three points each, and the points' spread about small planes [m]."""
    near = _distinct(points[np.abs(points[:, 0]) < _WALL_BAND])
    if len(near) < 100:
        raise InputError(f"{name}: only {len(near)} points lie on the largest upright plane, 100 are needed")
    tree = cKDTree(near[:, 1:])
    probes = near[:: max(1, len(near) // 400)]
    eighth = tree.query(probes[:, 1:], k=9)[0][:, -1]
    cell = float(np.clip(1.7 * 0.63 * np.median(eighth), _MIN_CELL, _MAX_CELL))
    extent = np.ptp(points[:, 1:], axis=0)
    cell = max(cell, float(np.sqrt(np.prod(extent) / _MAX_CELLS)))
    _, neighbours = tree.query(probes[:, 1:], k=min(120, len(near)))
    # Even made-up points without noise need a step that counts as an edge.
    return cell, max(float(np.median([_plane_spread(near[group]) for group in neighbours])), 1e-4)


def _distinct(points: Float[np.ndarray, "N 3"]) -> Float[np.ndarray, "M 3"]:
    """Points without repetitions, which some scanners write, to a tenth of a millimetre."""
    keys = np.round(1e4 * (points[:, 1:] - points[:, 1:].min(axis=0, initial=np.inf))).astype(np.int64)
    return points[np.unique(keys[:, 0] << 32 | keys[:, 1], return_index=True)[1]]


def _plane_spread(points: Float[np.ndarray, "K 3"]) -> float:
    design = np.column_stack([np.ones(len(points)), points[:, 1:] - points[:, 1:].mean(axis=0)])
    residual = points[:, 0] - design @ np.linalg.lstsq(design, points[:, 0], rcond=None)[0]
    return float(np.sqrt(np.sum(residual**2) / (len(points) - 3)))


def _wall_label(front: FrontSurface, name: str) -> int:
    """The region with most cells near the plane x = 0."""
    near = (np.abs(np.where(front.count > 0, front.depth, np.inf)) < _WALL_BAND) & (front.region > 0)
    if not near.any():
        raise InputError(f"{name}: the largest upright plane is too broken to be a wall")
    label = int(np.argmax(np.bincount(front.region[near])))
    rows, columns = np.nonzero(front.region == label)
    if min(np.ptp(rows), np.ptp(columns)) < _MIN_SPAN:
        raise InputError(f"{name}: the largest upright plane is a strip, too narrow to be a wall")
    return label


@dataclass(frozen=True)
class _Window:
    """A smoothing window that was tried on the wall.

    width: standard deviation [m]. jitter: rms angle of its normals from those of the next wider one [rad].
    spread, noise: rms of the wall's points about quadratics and about planes in it [m].
    """

    width: float
    jitter: float
    spread: float
    noise: float


def _choose_window(
    front: FrontSurface, points: Float[np.ndarray, "M 3"], lattice: Lattice, label: int, noise: float
) -> _Window:
    """The narrowest window whose normals agree with the next one's, or the widest that fits the points."""
    cell, wall = lattice.cell, front.region == label
    depth, weight = np.nan_to_num(front.depth), np.where(wall, front.count, 0.0)
    steps = int(np.ceil(2 * np.log2(max(_MAX_WIDTH, 4 * cell) / (1.5 * cell)))) + 1
    inner = ndimage.binary_erosion(wall, np.ones((3, 3)))
    jitter, width = np.inf, 1.5 * cell
    sheet = fit_sheet(depth, weight, wall, cell, width, noise)
    narrow = spread = _spread(_residuals(points, lattice, sheet.depth))
    for wider in 1.5 * cell * 2 ** (0.5 * np.arange(1, steps)):
        following = fit_sheet(depth, weight, wall, cell, float(wider), noise)
        # Windows that hang over the border are one-sided: they say nothing about the noise.
        full = inner & (following.support > 0.7 * np.percentile(following.support[wall], 95))
        gap = np.linalg.norm(_normals(following.depth, cell) - _normals(sheet.depth, cell), axis=-1)
        before, jitter = jitter, _rms(gap[full])
        loose = _spread(_residuals(points, lattice, following.depth))
        if jitter < _CALM or (jitter < _NOISY and jitter > _FALLS * before) or loose > _LOOSE * narrow:
            break
        sheet, width, spread = following, float(wider), loose
    flat = fit_sheet(depth, weight, wall, cell, width, noise, degree=1)
    return _Window(width, jitter, spread, _spread(_residuals(points, lattice, flat.depth)))


def _normals(depth: Float[np.ndarray, "V U"], cell: float) -> Float[np.ndarray, "V U 3"]:
    rise, run = np.gradient(depth, cell)
    stacked = np.stack([-np.ones_like(depth), run, rise], axis=-1)
    return stacked / np.linalg.norm(stacked, axis=-1, keepdims=True)


def _close_small_holes(front: FrontSurface, cell: float) -> Int[np.ndarray, "V U"]:
    """Regions grown over empty gaps narrower than 25 mm, or than two cells where those are wider."""
    reach = max(1, int(_SMALL_HOLE / cell / 2))
    closed = ndimage.binary_closing(front.region > 0, np.ones((3, 3)), iterations=reach)
    nearest = ndimage.distance_transform_edt(front.region == 0, return_distances=False, return_indices=True)
    fill = closed & (front.region == 0) & (front.count == 0)
    return np.where(fill, front.region[tuple(nearest)], front.region)


def _extended(labels: Int[np.ndarray, "V U"]) -> Int[np.ndarray, "V U"]:
    """Labels continued by two cells into unlabelled ground, so that splines at the border have support."""
    distance, nearest = ndimage.distance_transform_edt(labels == 0, return_indices=True)
    return np.where(distance < 3, labels[tuple(nearest)], 0)


def _alone(labels: Int[np.ndarray, "V U"]) -> Bool[np.ndarray, "V U"]:
    """Cells all of whose neighbours belong to the same region: a spline there mixes no two surfaces."""
    return ndimage.minimum_filter(labels, 3) == ndimage.maximum_filter(labels, 3)


def _explained(front: FrontSurface, depth: Float[np.ndarray, "V U"], noise: float) -> Bool[np.ndarray, "V U"]:
    return (front.count == 0) | (np.abs(np.where(front.count > 0, front.depth, 0.0) - depth) < _STRAY * noise)


def _residuals(
    points: Float[np.ndarray, "N 3"], lattice: Lattice, depth: Float[np.ndarray, "V U"]
) -> Float[np.ndarray, "N"]:
    """x of each point less that of the surface below it, by the very spline of HeightMap [m]."""
    rows = (points[:, 2] - lattice.low) / lattice.cell
    columns = (-points[:, 1] - lattice.left) / lattice.cell
    return points[:, 0] - ndimage.map_coordinates(
        depth, [rows, columns], order=2, prefilter=False, mode="nearest"
    )


def _spread(residual: Float[np.ndarray, "N"]) -> float:
    """Root mean square without strays."""
    scale = 1.4826 * float(np.median(np.abs(residual)))
    return max(_rms(residual[np.abs(residual) < _STRAY * scale]), 1e-5)


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.square(values)))) if values.size else 0.0
