"""Where on a captured wall a canvas fits best: inside the free plane, as far as can be from all else."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from scipy import ndimage

from jaxpaint.errors import InputError
from sims.scenes.baking import Baked
from sims.scenes.gridding import Lattice

_BAND, _BAND_NOISE = 0.015, 2.5
_MAX_SLOPE = np.tan(np.deg2rad(10.0))
_FLAT_BAND = 0.08
_MAX_TURN = np.tan(np.deg2rad(30.0))
_BORDER = 0.05
_MAX_SIZE = (2.4, 1.2)
_ASPECTS = (4.0, 3.0, 2.0, 1.5, 1.0, 0.75, 0.5)


@dataclass(frozen=True)
class Place:
    """Middle of a canvas in (u, v) of the lattice, its size, its distance from what is not free plane [m].

    free: area of the free plane [m^2].
    """

    u: float
    v: float
    size: tuple[float, float]
    clearance: float
    free: float


def find_place(baked: Baked, size: tuple[float, float] | None, name: str) -> Place:
    """The place of a canvas of that size, or of the largest up to 2.4 x 1.2 m that leaves a border of 5 cm.

    On the plane where it fits there, else anywhere on the wall's smooth surface, as on a captured column.
    Raises InputError with the largest size of the same shape that fits.
    """
    return place_in((find(baked) for find in (free_plane, free_surface)), baked.lattice, size, name)


def place_in(
    choices: Iterable[Bool[np.ndarray, "V U"]], lattice: Lattice, size: tuple[float, float] | None, name: str
) -> Place:
    """The place of a canvas in the first of several masks of free cells that has one; see `find_place`."""
    cell = lattice.cell
    for free in choices:
        blocked = _integral(~free)
        wanted = size if size is not None else _largest_of_any_shape(blocked, cell)
        if min(wanted) > 2 * cell and _fits(blocked, _cells(wanted, cell), 0).any():
            break
    else:
        width, height = _largest(blocked, cell, wanted, 0.0)
        raise InputError(
            f"--canvas-size: {wanted[0]:g} x {wanted[1]:g} m finds no free wall on {name}; "
            f"the largest canvas of that shape that fits is {width:.2f} x {height:.2f} m"
        )
    row, column, margin = _clearest(blocked, _cells(wanted, cell))
    return Place(
        u=lattice.left + column * lattice.cell,
        v=lattice.low + row * lattice.cell,
        size=wanted,
        clearance=margin * cell,
        free=float(free.sum()) * cell**2,
    )


def free_plane(baked: Baked) -> Bool[np.ndarray, "V U"]:
    """Cells of the wall near its plane and nearly parallel to it; specks of one or two cells are forgiven."""
    flat = baked.wall & (np.abs(baked.depth) < _FLAT_BAND)
    rows, columns = np.nonzero(flat)
    design = np.column_stack([np.ones(len(rows)), columns, rows])
    depth = baked.depth[flat]
    weight = np.ones(len(rows))
    for _ in range(10):
        plane = np.linalg.lstsq(design * weight[:, None], depth * weight, rcond=None)[0]
        gap = np.abs(depth - design @ plane)
        weight = np.sqrt(1.0 / np.maximum(gap, 1e-3))
    v, u = np.indices(baked.depth.shape)
    offset = np.abs(baked.depth - plane[0] - plane[1] * u - plane[2] * v)
    rise, run = np.gradient(baked.depth, baked.lattice.cell)
    slope = np.hypot(run - plane[1] / baked.lattice.cell, rise - plane[2] / baked.lattice.cell)
    level = (offset < max(_BAND, _BAND_NOISE * baked.noise)) & (slope < _MAX_SLOPE)
    uneven = ndimage.binary_opening(~level & baked.wall, np.ones((3, 3)))
    return baked.wall & ~uneven


def free_surface(baked: Baked) -> Bool[np.ndarray, "V U"]:
    """Cells of the wall, bent as it may be, that do not turn away from the robot by more than 30 degrees."""
    rise, run = np.gradient(baked.depth, baked.lattice.cell)
    steep = baked.wall & (np.hypot(run, rise) > _MAX_TURN)
    return baked.wall & ~ndimage.binary_opening(steep, np.ones((3, 3)))


def _largest_of_any_shape(blocked: Float[np.ndarray, "V1 U1"], cell: float) -> tuple[float, float]:
    sizes = [_largest(blocked, cell, (aspect, 1.0), _BORDER) for aspect in _ASPECTS]
    return max(sizes, key=lambda sides: sides[0] * sides[1])


def _cells(size: tuple[float, float], cell: float) -> tuple[int, int]:
    """Half width and half height in cells, rounded up: a window of 2 n + 1 cells covers the canvas."""
    return int(np.ceil(0.5 * size[0] / cell)), int(np.ceil(0.5 * size[1] / cell))


def _integral(blocked: Bool[np.ndarray, "V U"]) -> Float[np.ndarray, "V1 U1"]:
    return np.pad(blocked.astype(float).cumsum(axis=0).cumsum(axis=1), ((1, 0), (1, 0)))


def _fits(blocked: Float[np.ndarray, "V1 U1"], half: tuple[int, int], margin: int) -> Bool[np.ndarray, "V U"]:
    """Cells around which a window of the half sizes and margin holds nothing blocked, nor the border."""
    across, up = 2 * (half[0] + margin) + 1, 2 * (half[1] + margin) + 1
    rows, columns = blocked.shape[0] - 1, blocked.shape[1] - 1
    result = np.zeros((rows, columns), dtype=bool)
    if across > columns or up > rows:
        return result
    count = blocked[up:, across:] - blocked[:-up, across:] - blocked[up:, :-across] + blocked[:-up, :-across]
    result[up // 2 : rows - up // 2, across // 2 : columns - across // 2] = count < 0.5
    return result


def _clearest(blocked: Float[np.ndarray, "V1 U1"], half: tuple[int, int]) -> tuple[int, int, int]:
    """Row and column with the widest free margin, nearest to the middle of all such, and that margin."""
    low, high = 0, max(blocked.shape)
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if _fits(blocked, half, middle).any() else (low, middle)
    places = np.argwhere(_fits(blocked, half, low))
    best = places[np.argmin(((places - places.mean(axis=0)) ** 2).sum(axis=1))]
    return int(best[0]), int(best[1]), low


def _largest(
    blocked: Float[np.ndarray, "V1 U1"], cell: float, shape: tuple[float, float], border: float
) -> tuple[float, float]:
    """The largest size of the given shape, up to 2.4 x 1.2 m, that fits somewhere, in whole centimetres."""
    limit = min(_MAX_SIZE[0] / shape[0], _MAX_SIZE[1] / shape[1])
    low, high = 0.0, limit * (1 + 1e-6)
    for _ in range(16):
        middle = 0.5 * (low + high)
        half = _cells((shape[0] * middle + 2 * border, shape[1] * middle + 2 * border), cell)
        low, high = (middle, high) if _fits(blocked, half, 0).any() else (low, middle)
    return float(np.floor(100 * shape[0] * low) / 100), float(np.floor(100 * shape[1] * low) / 100)
