"""A picture as lines and areas, before anybody decides how and in which order it is painted."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Float

from jaxpaint.errors import InputError
from jaxpaint.pictures.reading import Reading

Polyline = Float[np.ndarray, "points 2"]
Colour = tuple[float, float, float]

DAB = 2e-3
"""The shortest stroke [m], a brush pressed down and lifted: short against any brush, yet a way to go."""

BLACK: Colour = (0.0, 0.0, 0.0)


@dataclass(frozen=True, eq=False)
class Area:
    """Ink in one connected piece. rings: its rim and the rims of its holes, each closed (even-odd).

    colour: index into the colours of the drawing.
    """

    rings: tuple[Polyline, ...]
    colour: int = 0


@dataclass(frozen=True, eq=False)
class Drawing:
    """The ink of a picture, in the picture's own units; u to the right, v UP.

    lines: centre-lines of strokes, in the order of the file; a closed one repeats its first point, and a dot
    has the same point twice. line_colours: the colour of each line. areas: what is seen of each fill; no two
    overlap. colours: sRGB from 0 to 1 in the order of painting, one pass each. ignored: how many things of
    each sort were in the file and are not drawn, or otherwise. reading: how well lines were read from pixels;
    None where none were.
    """

    lines: tuple[Polyline, ...]
    line_colours: tuple[int, ...]
    areas: tuple[Area, ...]
    colours: tuple[Colour, ...]
    name: str
    ignored: Mapping[str, int] = field(default_factory=dict)
    reading: Reading | None = None

    @property
    def closed(self) -> tuple[bool, ...]:
        """Per line, whether it ends where it starts."""
        return tuple(is_closed(line) for line in self.lines)

    @property
    def outlines(self) -> tuple[Polyline, ...]:
        """The rings of all areas."""
        return tuple(ring for area in self.areas for ring in area.rings)

    @property
    def bounds(self) -> tuple[Float[np.ndarray, "2"], Float[np.ndarray, "2"]]:
        """Lowest and highest (u, v) of all lines and areas."""
        points = np.concatenate([*self.lines, *self.outlines])
        return points.min(axis=0), points.max(axis=0)

    @property
    def length(self) -> float:
        """Length of all lines and outlines of areas together."""
        return float(sum(polyline_length(line) for line in (*self.lines, *self.outlines)))


def is_closed(line: Polyline) -> bool:
    """Whether a polyline ends exactly where it starts and goes somewhere in between."""
    return len(line) > 2 and bool((line[0] == line[-1]).all())


def polyline_length(line: Polyline) -> float:
    """Length of a polyline, in its own units."""
    return float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum())


def at_least(line: Polyline, length: float = DAB) -> Polyline:
    """A line drawn out to a length [m] where it is shorter; a point becomes a line along u."""
    middle, span = (line[0] + line[-1]) / 2, float(np.linalg.norm(line[-1] - line[0]))
    if polyline_length(line) >= length:
        return line
    along = (line[-1] - line[0]) / span if span > 1e-9 else np.array([1.0, 0.0])
    return middle + np.outer([-length / 2, length / 2], along)


def fit(drawing: Drawing, size: tuple[float, float]) -> Drawing:
    """The drawing in canvas metres: as large as fits size (width, height) [m], aspect kept, centred on 0.

    What is fitted is the ink (its bounds), not the page that it stands on. Dots become dabs, 2 mm long. A
    size that is not two positive finite numbers is an InputError, and so is a drawing of a single dot, which
    has no size of its own.
    """
    room = np.asarray(size, dtype=float)
    if room.shape != (2,) or not (np.isfinite(room) & (room > 0)).all():
        raise InputError(f"canvas size: found {size}; allowed are two positive lengths in metres")
    lower, upper = drawing.bounds
    extent = upper - lower
    if not extent.any():
        raise InputError(f"{drawing.name}: found a single dot; allowed is a drawing with a width or a height")
    scale = min(room[axis] / extent[axis] for axis in (0, 1) if extent[axis] > 0)
    middle = (lower + upper) / 2

    def placed(lines: tuple[Polyline, ...]) -> tuple[Polyline, ...]:
        return tuple((line - middle) * scale for line in lines)

    lines = tuple(line if polyline_length(line) else at_least(line) for line in placed(drawing.lines))
    areas = tuple(replace(area, rings=placed(area.rings)) for area in drawing.areas)
    return replace(drawing, lines=lines, areas=areas)
