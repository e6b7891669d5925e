"""Parallel rows inside a region, joined to and fro."""

import numpy as np
import shapely
from shapely import affinity
from shapely.geometry.base import BaseGeometry

from jaxpaint.pictures.drawing import Polyline
from jaxpaint.pictures.regions import polygons

_REACH = 3.0  # rows apart: longer joints between the ends of rows are not painted but travelled


def hatch(
    rows: BaseGeometry, core: shapely.Polygon, radius: float, overlap: float, angle: float
) -> list[Polyline]:
    """Rows at an angle [rad] through a region inside a core whose rim is painted.

    A row stands 2 r (1 - overlap) from the next at most. Rows whose ends can be joined inside the core become
    one line.
    """
    step = 2 * radius * (1 - overlap)
    lines: list[Polyline] = []
    turned, back = affinity.rotate(core, -angle, origin=(0, 0), use_radians=True), _rotation(angle)
    shapely.prepare(turned)
    for piece in polygons(affinity.rotate(rows, -angle, origin=(0, 0), use_radians=True)):
        lines += [line @ back.T for line in _joined(_chords(piece, step), turned, step)]
    return lines


def _rotation(angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])


def _chords(piece: shapely.Polygon, step: float) -> list[np.ndarray]:
    """Per row from the lowest, its chords [n, 2 ends, 2] in a region; the rows share its height evenly."""
    left, low, right, high = piece.bounds
    count = max(1, int(np.ceil((high - low) / step - 1e-9)))
    heights = low + (np.arange(count) + 0.5) * (high - low) / count
    ends = np.stack([np.column_stack([np.full(count, x), heights]) for x in (left - 1, right + 1)], axis=1)
    rows = [shapely.LineString(row) for row in ends]
    return [_ends_of(row.intersection(piece)) for row in rows]


def _ends_of(geometry: BaseGeometry) -> np.ndarray:
    """First and last points of the pieces of one row, from left to right."""
    pieces = [
        np.array(part.coords)[[0, -1]]
        for part in shapely.get_parts(geometry)
        if isinstance(part, shapely.LineString) and part.length > 0
    ]
    chords = [piece if piece[0, 0] <= piece[1, 0] else piece[::-1] for piece in pieces]
    return np.array(sorted(chords, key=lambda chord: chord[0, 0])).reshape(-1, 2, 2)


def _joined(rows: list[np.ndarray], region: BaseGeometry, step: float) -> list[Polyline]:
    """Chords as lines to and fro: on to the next row where the way there is short and inside the region."""
    left = [list(range(len(row))) for row in rows]
    lines = []
    for k in range(len(rows)):
        while left[k]:
            chord = rows[k][left[k].pop(0)]
            line = [chord[0], chord[1]]
            for after in range(k + 1, len(rows)):
                found = _next(line[-1], rows[after], left[after], region, step)
                if found is None:
                    break
                left[after].remove(found[0])
                line += found[1]
            lines.append(np.array(line))
    return lines


def _next(here: np.ndarray, row: np.ndarray, free: list[int], region: BaseGeometry, step: float):
    """The chord of a row that goes on from a point, and its ends in the order in which they are painted."""
    best = None
    for i in free:
        for first in (0, 1):
            way = float(np.linalg.norm(row[i, first] - here))
            if way <= _REACH * step and (best is None or way < best[0]):
                best = (way, i, first)
    if best is None or not region.covers(shapely.LineString([here, row[best[1], best[2]]])):
        return None
    return best[1], [row[best[1], best[2]], row[best[1], 1 - best[2]]]
