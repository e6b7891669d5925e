"""Curves to follow in one stroke: 3 m or more, the straight line less, so wide that the base must travel."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float

Curve = Float[np.ndarray, "points 2"]
"""Points (u to the right, v up) about the middle of the canvas [m]."""

_POINTS = 2000


def lemniscate(width: float = 1.6, height: float = 0.5) -> Curve:
    """A figure of eight, twice through its middle: both ways along the wall, 4.0 m."""
    turn = np.linspace(0, 2 * np.pi, _POINTS)
    return np.stack([width / 2 * np.sin(turn), height / 2 * np.sin(2 * turn)], axis=1)


def wave(width: float = 2.4, height: float = 0.5, periods: float = 2.0) -> Curve:
    """A sine from left to right, 3.2 m."""
    u = np.linspace(-width / 2, width / 2, _POINTS)
    return np.stack([u, height / 2 * np.sin(2 * np.pi * periods * u / width)], axis=1)


def line(width: float = 2.3) -> Curve:
    """A straight stroke from left to right, longer than any place of the base reaches."""
    u = np.linspace(-width / 2, width / 2, _POINTS)
    return np.stack([u, 0 * u], axis=1)


def scroll(width: float = 1.6, radius: float = 0.07, loops: int = 7) -> Curve:
    """Loops one after the other from left to right, as an ornament has them, 3.3 m: the brush goes to and
    fro, the base need not.
    """
    turn = np.linspace(0, 2 * np.pi * loops, _POINTS)
    u = width * (turn / turn[-1] - 0.5) + radius * np.sin(turn)
    return _evenly(np.stack([u, radius * np.cos(turn)], axis=1))


def meander(width: float = 1.2, rows: int = 3, gap: float = 0.12) -> Curve:
    """Rows to and fro joined by half circles, as areas are filled, 4.0 m."""
    parts = []
    for row in range(rows):
        v, side = ((rows - 1) / 2 - row) * gap, 1 - 2 * (row % 2)
        parts.append([(-side * width / 2, v), (side * width / 2, v)])
        if row < rows - 1:
            turn = np.linspace(np.pi / 2, -np.pi / 2, 30)[1:-1]
            parts.append(
                [(side * (width + gap * np.cos(a)) / 2, v - gap / 2 * (1 - np.sin(a))) for a in turn]
            )
    return _evenly(np.concatenate(parts))


CURVES: dict[str, Callable[[], Curve]] = {
    "lemniscate": lemniscate,
    "line": line,
    "meander": meander,
    "scroll": scroll,
    "wave": wave,
}


def _evenly(points: Curve) -> Curve:
    """The same line, in points of equal distance."""
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    place = np.linspace(0, along[-1], _POINTS)
    return np.stack([np.interp(place, along, points[:, k]) for k in (0, 1)], axis=1)
