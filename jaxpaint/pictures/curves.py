"""Cubic Bezier curves, the one form to which every segment of an SVG path is brought."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from jaxpaint.pictures.drawing import Polyline

Controls = Float[np.ndarray, "segments 4 2"]


@dataclass(frozen=True, eq=False)
class Curve:
    """Consecutive cubic segments, each by its four control points, and whether the last ends in the first."""

    controls: Controls
    closed: bool

    def moved(self, matrix: Float[np.ndarray, "3 3"]) -> "Curve":
        """The curve under an affine map, exact also for skews because it acts on control points."""
        return replace(self, controls=self.controls @ matrix[:2, :2].T + matrix[:2, 2])

    def closing(self) -> "Curve":
        """The outline of the area that the curve encloses: ended by a straight line where it is open."""
        start, end = self.controls[0, 0], self.controls[-1, 3]
        back = self.controls[:0] if (start == end).all() else straight(end, start)[None]
        return Curve(np.concatenate([self.controls, back]), closed=True)

    def encloses_area(self, tolerance: float) -> bool:
        """Whether the control points leave a straight line by more than a tolerance."""
        points = self.controls.reshape(-1, 2)
        spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
        return bool(spread[-1] > tolerance)

    def pieces(self, tolerance: float) -> np.ndarray:
        """How many chords each segment needs to stay within a tolerance of it.

        A chord over 1/n of the parameter is off by at most max|B''| / (8 n^2), and B'' of a cubic is at most
        six times the larger second difference of its control points.
        """
        bend = np.linalg.norm(np.diff(self.controls, n=2, axis=1), axis=-1).max(axis=1)
        return np.maximum(1, np.ceil(np.sqrt(0.75 * bend / tolerance))).astype(int)

    def flattened(self, tolerance: float) -> Polyline:
        """Points on the curve, joints of segments among them, whose chords stay within a tolerance."""
        pieces = self.pieces(tolerance)
        first = np.repeat(np.cumsum(pieces) - pieces, pieces)
        t = ((np.arange(pieces.sum()) - first + 1) / np.repeat(pieces, pieces))[:, None]
        c = np.repeat(self.controls, pieces, axis=0).transpose(1, 0, 2)
        s = 1 - t
        points = s**3 * c[0] + 3 * s**2 * t * c[1] + 3 * s * t**2 * c[2] + t**3 * c[3]
        return np.concatenate([self.controls[:1, 0], points])


def straight(start: Float[np.ndarray, "2"], end: Float[np.ndarray, "2"]) -> Float[np.ndarray, "4 2"]:
    """A line as a cubic segment."""
    return start + np.linspace(0.0, 1.0, 4)[:, None] * (end - start)


def chain(points: Polyline, closed: bool) -> Curve:
    """A curve of straight segments through points, back to the first one if closed."""
    points = np.concatenate([points, points[:1]]) if closed else points
    start, end = points[:-1, None], points[1:, None]
    return Curve(start + np.linspace(0.0, 1.0, 4)[:, None] * (end - start), closed)
