"""Pieces of walls, straight or evenly curved, from the segments of a scan."""

import dataclasses

import numpy as np
from jaxtyping import Float

from jaxpaint.localisation.arc_fit import ArcFit
from jaxpaint.localisation.line_fit import LineFit
from jaxpaint.localisation.splitting import FEWEST, segments_of

SHORTEST = 0.08
"""Length of a piece [m]."""
# Curved segments are cut into pieces that are this deep at most [m], and that turn by this much [rad]: an
# echo finds its piece by the tangent at the piece's middle.
_DEPTH = 0.02
_TURN = 0.7


@dataclasses.dataclass(frozen=True)
class Piece:
    """start, end: ends on the surface [m]. normal: at the middle, unit, towards the scanner. curvature: above
    0 for a column [1/m]. sigma: standard deviation of the place [m].
    """

    start: Float[np.ndarray, "2"]
    end: Float[np.ndarray, "2"]
    normal: Float[np.ndarray, "2"]
    curvature: float
    sigma: float

    @property
    def length(self) -> float:
        """From end to end [m]."""
        return float(np.linalg.norm(self.end - self.start))


def pieces_of(run: Float[np.ndarray, "m 2"], sigma: float) -> list[Piece]:
    """The pieces of one run of echoes, relative to the scanner; what is too short for one is left out.

    sigma: of a range [m].
    """
    pieces = []
    for fit in segments_of(run, sigma):
        pieces += [_straight(fit, sigma)] if isinstance(fit, LineFit) else _curved(fit, sigma)
    return [piece for piece in pieces if piece.length >= SHORTEST]


def _straight(fit: LineFit, sigma: float) -> Piece:
    start, end = (fit.middle + fit.along[i] * fit.tangent for i in (0, -1))
    return Piece(start, end, fit.normal, 0.0, fit.place_sigma(sigma))


def _curved(fit: ArcFit, sigma: float) -> list[Piece]:
    """Pieces of one circle. They share what it is wrong by, and so each counts for its share."""
    first, last = fit.angle[0], fit.angle[-1]
    turn = min(_TURN, 2 * np.arccos(max(1 - _DEPTH / fit.radius, 0.0)))
    count = max(1, int(np.ceil(abs(last - first) / turn)))
    each = fit.place_sigma(sigma) * np.sqrt(count)
    edges = np.linspace(first, last, count + 1)
    held = np.histogram(fit.angle, np.sort(edges))[0]
    pieces = []
    for a, b, echoes in zip(edges[:-1], edges[1:], held if last > first else held[::-1], strict=True):
        start, middle, end = (np.array([np.cos(x), np.sin(x)]) for x in (a, (a + b) / 2, b))
        ends = fit.center + fit.radius * start, fit.center + fit.radius * end
        if echoes >= FEWEST:
            pieces.append(Piece(*ends, fit.faces * middle, fit.faces / fit.radius, each))
    return pieces
