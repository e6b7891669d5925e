"""How far the paint's lines and edges lie from the picture's."""

from collections.abc import Sequence
from typing import NamedTuple

import cv2
import numpy as np
from jaxtyping import Bool, Float
from scipy.spatial import KDTree

from sims.scoring.contours import contour
from sims.scoring.ground import CELL, Ground, distance_to
from sims.scoring.lines import densify
from sims.scoring.wanted import Layer

# Between neighbouring samples of a brush that was moved, not swept: eight times what the usual speed makes
# [m].
_JUMP = 0.020


class Part(NamedTuple):
    """Symmetric distances [m] of one sort of one colour; their weights add up to 1, or there are none.

    length: of what was wanted [m], the weight of this part in a picture.
    """

    distances: Float[np.ndarray, "samples"]
    weights: Float[np.ndarray, "samples"]
    length: float


def track(uv: Float[np.ndarray, "time 2"], down: Bool[np.ndarray, "time"]) -> Float[np.ndarray, "samples 2"]:
    """The swept brush centre at even steps of a cell, so that a brush at rest weighs no more."""
    down = down & np.isfinite(uv).all(1)
    near = np.linalg.norm(np.diff(np.where(down[:, None], uv, 0), axis=0), axis=1) < _JUMP
    cuts = np.flatnonzero(~(down[1:] & down[:-1] & near)) + 1
    pieces = [p for p, d in zip(np.split(uv, cuts), np.split(down, cuts), strict=True) if d[0]]
    return np.concatenate([densify(p, CELL) for p in pieces]) if pieces else np.zeros((0, 2))


def line_part(layer: Layer, ground: Ground, swept: Float[np.ndarray, "samples 2"]) -> Part | None:
    """Between the brush's centre and the centre-lines; None where the layer has no lines.

    What is swept nearer to an area than to a line fills the area, and has no centre-line to be on.
    """
    if layer.tree is None:
        return None
    if not len(swept):
        return _nothing(layer.line_length)
    back = KDTree(swept).query(layer.tree.data)[0]
    if layer.edge_tree is not None:
        cells = ground.index(swept)
        swept = swept[layer.centre_distance.ravel()[cells] <= layer.ink_distance.ravel()[cells]]
    there = layer.tree.query(swept)[0] if len(swept) else np.zeros(0)
    return _symmetric(there, np.ones(len(there)), back, layer.line_length)


def edge_part(
    layer: Layer, ground: Ground, film: Float[np.ndarray, "rows columns"], least: float, radius: float
) -> Part | None:
    """Between the paint's boundary and that of the filled areas; None where the layer has no areas.

    Bare ground between rows is a matter of coverage: see `_without_gaps`. So is the paint's end at a rim or a
    fold. What ends beside a centre-line belongs to that line.
    """
    if layer.edge_tree is None:
        return None
    found = contour(_without_gaps(film, layer.mask, least, radius), least)
    points = ground.origin + CELL * found.middle
    if not len(points):
        return _nothing(layer.edge_length)
    counted = _of_areas(layer, ground, points, radius)
    there = layer.edge_tree.query(points[counted])[0] if counted.any() else np.zeros(0)
    back = KDTree(points).query(layer.edge_tree.data)[0]
    return _symmetric(there, found.length[counted], back, layer.edge_length)


def pooled(parts: Sequence[Part]) -> tuple[float, float]:
    """Mean and 95th percentile [m] over all parts, each with the weight of its length.

    NaN without parts, and where anything that was wanted has no counterpart at all.
    """
    if not parts or not all(len(part.distances) for part in parts):
        return float("nan"), float("nan")
    total = sum(part.length for part in parts)
    distances = np.concatenate([part.distances for part in parts])
    weights = np.concatenate([part.weights * (part.length / total) for part in parts])
    order = np.argsort(distances)
    p95 = distances[order][np.searchsorted(np.cumsum(weights[order]), 0.95)]
    return float((distances * weights).sum()), float(p95)


def _symmetric(there: np.ndarray, shares: np.ndarray, back: np.ndarray, length: float) -> Part:
    """Distances both ways, each way with half of the weight; the way back has all of it alone."""
    half = 0.5 if shares.sum() > 0 else 1.0
    weights = np.concatenate([0.5 * shares / (shares.sum() or 1.0), np.full(len(back), half / len(back))])
    return Part(np.concatenate([there, back]), weights, length)


def _nothing(length: float) -> Part:
    return Part(np.zeros(0), np.zeros(0), length)


def _of_areas(layer: Layer, ground: Ground, points: np.ndarray, radius: float) -> np.ndarray:
    """Which points of the paint's boundary an area must answer for."""
    cells = ground.index(points)
    from_line = np.abs(layer.centre_distance.ravel()[cells] - radius)
    return layer.paintable.ravel()[cells] & (np.abs(layer.ink_distance.ravel()[cells]) <= from_line)


def _without_gaps(film: np.ndarray, mask: np.ndarray, least: float, radius: float) -> np.ndarray:
    """The film with bare ground inside the ink filled in: what is enclosed, and slits between rows.

    A slit is narrower than the brush's radius; a wider one that opens to the outside is a missing row, whose
    banks are boundary.
    """
    painted = film >= least
    if not painted.any():
        return film
    reach = 0.5 * radius
    grown = distance_to(painted) <= reach
    closed = distance_to(~grown) > reach if not grown.all() else grown
    _, labels = cv2.connectedComponents((~painted).astype(np.uint8), connectivity=4)
    piece = np.asarray(labels, np.int32)
    outside = np.zeros(piece.max() + 1, bool)
    outside[piece[~mask]] = True
    gap = ~painted & mask & (closed | ~outside[piece])
    return np.where(gap, np.float32(2 * least), film)
