"""Points along a line at even spacing, its corners among them."""

import numpy as np

from jaxpaint.pictures.drawing import Polyline

CORNER = np.radians(20)  # a sharper turn is a corner


def resample(line: Polyline, spacing: float) -> Polyline:
    """Points of a line at most `spacing` apart along it; ends and corners (turns above 20 degrees) stay."""
    steps = np.linalg.norm(np.diff(line, axis=0), axis=1)
    line = line[np.concatenate([[True], steps > 0])]
    along = np.concatenate([[0.0], np.cumsum(steps[steps > 0])])
    marks = along[np.concatenate([[0], corners(line), [len(line) - 1]])]
    parts = np.maximum(1, np.ceil(np.diff(marks) / spacing * (1 - 1e-9))).astype(int)
    at = [np.linspace(a, b, n, endpoint=False) for a, b, n in zip(marks, marks[1:], parts, strict=False)]
    s = np.concatenate([*at, marks[-1:]])
    points = np.stack([np.interp(s, along, line[:, axis]) for axis in (0, 1)], axis=1)
    points[-1] = line[-1]
    return points


def corners(line: Polyline) -> np.ndarray:
    """Indices of the inner points at which a line turns by more than 20 degrees."""
    d = np.diff(line, axis=0)
    cross = d[:-1, 0] * d[1:, 1] - d[:-1, 1] * d[1:, 0]
    turn = np.abs(np.arctan2(cross, (d[:-1] * d[1:]).sum(axis=1)))
    return np.flatnonzero(turn > CORNER) + 1
