"""How sharp refinement leaves an edge where two known planes meet.

Everything is measured across the edge, with c the coordinate along the bisector of the two faces, from the
edge into the wedge between them, and s the coordinate square to it. With theta half the angle between the
faces, they are c = |s| cot(theta), and a point's cut is x = c - |s| cot(theta): above zero where the edge is
cut short, both at an inside corner, where material is added, and at an outside edge, where it is taken away.
A fillet of radius r has c(s) = r / sin(theta) - sqrt(r^2 - s^2) up to |s| = r cos(theta), depth
r (1 / sin(theta) - 1) in the middle, and cuts the area r^2 (cot(theta) - pi / 2 + theta) off the edge.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

_BINS = 12
"""Strips across each side of the edge, so that a scan's uneven density counts for nothing."""


@dataclass(frozen=True)
class Edge:
    """A straight edge between two flat faces.

    start, end: of the edge [m]. first, second: unit vectors in the two faces, square to the edge and away
    from it.
    """

    start: Float[np.ndarray, "3"]
    end: Float[np.ndarray, "3"]
    first: Float[np.ndarray, "3"]
    second: Float[np.ndarray, "3"]

    @property
    def half_angle(self) -> float:
        """Half the angle between the faces [rad]."""
        between = np.linalg.norm(np.subtract(self.first, self.second))
        return float(np.arctan2(between, np.linalg.norm(np.add(self.first, self.second))))


@dataclass(frozen=True)
class EdgeSharpness:
    """What is left of an edge, from the points near it.

    mean, p95: distance of the points from the true faces [m]. rounding: radius of the fillet that cuts the
    same area off the edge [m]; negative where points lie outside of it. depth: mean cut x of the points in
    the middle strips [m]. count: points. All but the count are NaN where a strip has no points.
    """

    mean: float
    p95: float
    rounding: float
    depth: float
    count: int


def edge_sharpness(points: Float[np.ndarray, "N 3"], edge: Edge, *, reach: float) -> EdgeSharpness:
    """Sharpness of an edge, from the points within `reach` [m] of it and between its ends.

    The area is that between strips of equal width over |s| <= reach sin(theta), of each the mean of x; with
    it rounding = sign(area) sqrt(|area| / (cot(theta) - pi / 2 + theta)). Fillets up to a radius of
    reach tan(theta) lie within. Noise of standard deviation sigma makes the rounding of a sharp edge
    negative, by about two sigma, as a point beyond the edge counts on the other side of it; a thousand points
    leave it uncertain by as much. Raises ValueError where the faces are one plane or one on the other, or
    `reach` is not above zero.
    """
    theta = edge.half_angle
    if not (np.isfinite(reach) and reach > 0):
        raise ValueError(f"reach: {reach} found, a length above 0 is allowed")
    if not 1e-3 < theta < np.pi / 2 - 1e-3:
        raise ValueError(f"edge: {2 * theta:.4f} rad between its faces found, 0 < angle < pi is allowed")
    c, s = _across(np.asarray(points, np.float64), edge, reach)
    cut = c - s / np.tan(theta)
    strip = np.minimum((s / (reach * np.sin(theta)) * _BINS).astype(int), _BINS)
    count = np.bincount(strip, minlength=_BINS + 1)[:_BINS]
    if not count.all():
        return EdgeSharpness(np.nan, np.nan, np.nan, np.nan, len(c))
    mean_cut = np.bincount(strip, cut, _BINS + 1)[:_BINS] / count
    area = 2 * reach * np.sin(theta) * mean_cut.mean()
    rounding = np.sign(area) * np.sqrt(abs(area) / (1 / np.tan(theta) - np.pi / 2 + theta))
    distance = _distance(c, s, theta)
    return EdgeSharpness(
        float(distance.mean()),
        float(np.percentile(distance, 95)),
        float(rounding),
        float(mean_cut[0]),
        len(c),
    )


def _across(points, edge, reach):
    """Coordinates c and |s| of the points near the edge [m]."""
    start, length = np.asarray(edge.start, np.float64), np.linalg.norm(np.subtract(edge.end, edge.start))
    along = np.subtract(edge.end, edge.start) / length
    inward = np.add(edge.first, edge.second) / np.linalg.norm(np.add(edge.first, edge.second))
    sideways = np.subtract(edge.first, edge.second) / np.linalg.norm(np.subtract(edge.first, edge.second))
    about = points - start
    place, c, s = about @ along, about @ inward, np.abs(about @ sideways)
    near = (place >= 0) & (place <= length) & (c * c + s * s <= reach * reach)
    return c[near], s[near]


def _distance(c, s, theta):
    """From the nearer face, or from the edge for points before both."""
    out, off = c * np.cos(theta) + s * np.sin(theta), c * np.sin(theta) - s * np.cos(theta)
    return np.where(out >= 0, np.abs(off), np.hypot(c, s))
