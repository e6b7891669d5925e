"""Strokes along the middle of ink: where it is narrower than the brush, and between other passes."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Bool, Float
from shapely.geometry.base import BaseGeometry

from jaxpaint.pictures.drawing import Polyline, at_least, is_closed, polyline_length
from jaxpaint.pictures.regions import polygons
from jaxpaint.pictures.skeleton import CentreLine, centre_lines, half_width, sampled

_CELLS = 8  # pixels to a brush radius
_SHELL = 3  # pixels
_MOST = 16_000_000  # pixels
_SUBPIXEL = 4  # fractional bits of cv2's polygons
_CORNER = 0.25  # of the radius: less deep bare tips, such as of right angles, get no stroke
_GAP = 1.0  # of the radius: needed parts of one line nearer than this are painted as one


@dataclass(frozen=True, eq=False)
class Middles:
    """Ink by regions: the cores that are painted along their rims, what that leaves bare inside of them, and
    where nothing is missing (solid).
    """

    regions: Sequence[BaseGeometry]
    cores: Sequence[BaseGeometry]
    bare: Sequence[BaseGeometry]
    solid: Sequence[BaseGeometry]


def middle_lines(middles: Middles, radius: float, inset: float) -> list[Polyline]:
    """Lines [m] along the middle of ink wherever passes along the rims of its cores leave it bare.

    A point x of the middle, w from the rim of the ink and c from the core, is the middle of ink out to w that
    is painted up to `radius` from the core: bare is what has c + w > radius, and what is said to be.
    """
    pieces = _polygons(middles.regions)
    if not pieces:
        return []
    bounds = np.array([piece.bounds for piece in pieces])
    lower, upper = bounds[:, :2].min(axis=0), bounds[:, 2:].max(axis=0)
    cell = max(radius / _CELLS, float(np.sqrt(np.prod(upper - lower + 4 * radius) / _MOST)))
    origin = lower - 4 * cell
    shape = tuple(int(n) for n in np.ceil((upper - lower) / cell + 9)[::-1])
    ink, core, bare, solid = (
        raster(parts, origin, cell, shape)
        for parts in (pieces, *(_polygons(of) for of in (middles.cores, middles.bare, middles.solid)))
    )
    # Thinning takes time with the width of what is thinned.
    shell = ink & ~(half_width(solid) > _SHELL)
    away = _distance_to(core)
    unpainted = ink & (away > radius / cell + 1)
    fields = _Fields(half_width(ink), away, bare.astype(float), _distance_to(unpainted))
    lines = [
        part * cell + origin
        for line in centre_lines(shell, line_art=False)
        for part in _needed(line, fields, radius / cell, inset / cell)
    ]
    return [at_least(line) for line in lines]


def _polygons(regions: Sequence[BaseGeometry]) -> list:
    return [piece for region in regions for piece in polygons(region)]


def raster(
    pieces: list, origin: Float[np.ndarray, "2"], cell: float, shape: tuple[int, ...]
) -> Bool[np.ndarray, "rows columns"]:
    """Polygons as pixels; what is thinner than a pixel still has one."""
    picture = np.zeros(shape, np.uint8)
    for piece in pieces:
        rings = [np.array(ring.coords) for ring in (piece.exterior, *piece.interiors)]
        fixed = [np.rint((ring - origin) / cell * 2**_SUBPIXEL).astype(np.int32) for ring in rings]
        cv2.fillPoly(picture, fixed, 1, shift=_SUBPIXEL)
    return picture.astype(bool)


def _distance_to(pixels: Bool[np.ndarray, "rows columns"]) -> Float[np.ndarray, "rows columns"]:
    return cv2.distanceTransform((~pixels).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE)


@dataclass(frozen=True, eq=False)
class _Fields:
    """Over the pixels: distance to the rim of the ink, to the core, whether the core is bare there, and the
    distance to ink that passes along the core's rims do not reach.
    """

    width: Float[np.ndarray, "rows columns"]
    away: Float[np.ndarray, "rows columns"]
    bare: Float[np.ndarray, "rows columns"]
    unpainted: Float[np.ndarray, "rows columns"]


def _needed(line: CentreLine, fields: _Fields, radius: float, inset: float) -> Iterator[Polyline]:
    """The parts of a centre-line that must be painted. All lengths in pixels."""
    points = line.points
    w, c = sampled(fields.width, points), sampled(fields.away, points)
    # Inside the core it is known what is bare. At a waist between two cores the rim of the ink lies aside,
    # not away from them, and both may reach it.
    missing = np.where((c > 0.5) & (sampled(fields.unpainted, points) < w + 1), c + w - radius, 0.0)
    need = (missing > 0.5) | (sampled(fields.bare, points) > 0.5)
    for first, last in _runs(need, points, _GAP * radius):
        if missing[first : last + 1].max() <= 0.5 and polyline_length(points[first : last + 1]) < radius:
            continue  # where passes meet at an angle; the brush is rounder than that
        trims = [
            max(0.0, inset - w[k]) if free and k in (0, len(points) - 1) else 0.0
            for k, free in ((first, line.free[0]), (last, line.free[1]))
        ]
        part = _trimmed(points[first : last + 1], *trims)
        if part is not None:
            yield part
        elif missing[first : last + 1].max() > _CORNER * radius:
            yield points[[first, last]].mean(axis=0) + np.array([[-1e-6, 0], [1e-6, 0]])


def _runs(need: np.ndarray, points: Polyline, gap: float) -> list[tuple[int, int]]:
    """First and last points of the parts that are needed, those joined that are nearer than a gap."""
    at = np.flatnonzero(need)
    if len(at) == 0:
        return []
    if need.all() and is_closed(points):
        return [(0, len(points) - 1)]
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    cut = np.flatnonzero(along[at[1:]] - along[at[:-1]] > gap)
    firsts, lasts = at[np.concatenate([[0], cut + 1])], at[np.concatenate([cut, [len(at) - 1]])]
    return [(int(a), int(b)) for a, b in zip(firsts, lasts, strict=True)]


def _trimmed(points: Polyline, start: float, end: float) -> Polyline | None:
    """A line less these lengths at its ends; None where less than a pixel is left."""
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    if along[-1] - start - end < 1.0:
        return None
    inner = along[(along > start) & (along < along[-1] - end)]
    s = np.concatenate([[start], inner, [along[-1] - end]])
    return np.stack([np.interp(s, along, points[:, axis]) for axis in (0, 1)], axis=1)
