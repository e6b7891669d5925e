"""Line art as polylines, before anybody decides in which order it is painted."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Float

from jaxpaint.errors import InputError

Polyline = Float[np.ndarray, "points 2"]


@dataclass(frozen=True, eq=False)
class Drawing:
    """The lines of a picture, in the picture's own units; u to the right, v UP.

    lines: centre-lines of strokes and outlines of fills, in the order of the file; an outline repeats its
    first point. filled: per line, whether it bounds a fill. ignored: how many things of each sort were in the
    file and are not drawn.
    """

    lines: tuple[Polyline, ...]
    filled: tuple[bool, ...]
    name: str
    ignored: Mapping[str, int] = field(default_factory=dict)

    @property
    def closed(self) -> tuple[bool, ...]:
        """Per line, whether it ends where it starts."""
        return tuple(is_closed(line) for line in self.lines)

    @property
    def bounds(self) -> tuple[Float[np.ndarray, "2"], Float[np.ndarray, "2"]]:
        """Lowest and highest (u, v) of all lines."""
        points = np.concatenate(self.lines)
        return points.min(axis=0), points.max(axis=0)

    @property
    def length(self) -> float:
        """Length of all lines together."""
        return float(sum(polyline_length(line) for line in self.lines))


def is_closed(line: Polyline) -> bool:
    """Whether a polyline ends exactly where it starts and goes somewhere in between."""
    return len(line) > 2 and bool((line[0] == line[-1]).all())


def polyline_length(line: Polyline) -> float:
    """Length of a polyline, in its own units."""
    return float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum())


def fit(drawing: Drawing, size: tuple[float, float]) -> Drawing:
    """The drawing in canvas metres: as large as fits size (width, height) [m], aspect kept, centred on 0.

    What is fitted is the ink (its bounds), not the page that it stands on. A size that is not two positive
    finite numbers is an InputError.
    """
    room = np.asarray(size, dtype=float)
    if room.shape != (2,) or not (np.isfinite(room) & (room > 0)).all():
        raise InputError(f"canvas size: found {size}; allowed are two positive lengths in metres")
    lower, upper = drawing.bounds
    extent = upper - lower
    scale = min(room[axis] / extent[axis] for axis in (0, 1) if extent[axis] > 0)
    middle = (lower + upper) / 2
    return replace(drawing, lines=tuple((line - middle) * scale for line in drawing.lines))
