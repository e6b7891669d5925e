"""Ordered strokes: lines and what fills areas, in the order in which they are painted, colour by colour."""

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from jaxtyping import Float, Int

from jaxpaint.errors import InputError
from jaxpaint.pictures.drawing import Drawing, Polyline, polyline_length
from jaxpaint.pictures.fills import FillSettings, fill_strokes, outlined
from jaxpaint.pictures.joining import join_lines
from jaxpaint.pictures.resampling import resample
from jaxpaint.pictures.routes import file_route, greedy_route, painted, shortened, travel
from jaxpaint.pictures.writing import WIDTH, base_travel, columns, cut, in_columns

_DOT = 1e-3  # [m]: a brush 20 mm wide makes no line of it

Order = Literal["writing", "shortest", "file"]


@dataclass(frozen=True, eq=False)
class Strokes:
    """Pen-down points in the order in which they are painted.

    points: canvas metres, u to the right and v up. stroke: the stroke of each point, counted from 0. colour:
    of each stroke, an index into the colours of the drawing; it never falls: each colour is one pass. length:
    of all strokes [m]. travel: from the end of each stroke to the start of the next [m]. dropped: lines left
    out because they are shorter than 1 mm.
    """

    points: Float[np.ndarray, "points 2"]
    stroke: Int[np.ndarray, " points"]
    colour: Int[np.ndarray, " strokes"]
    length: float
    travel: float
    dropped: int

    @property
    def count(self) -> int:
        """How many strokes there are."""
        return len(self.colour)

    @property
    def lines(self) -> list[Polyline]:
        """The points of each stroke."""
        return np.split(self.points, np.flatnonzero(np.diff(self.stroke)) + 1)


def plan_strokes(
    drawing: Drawing,
    spacing: float,
    *,
    radius: float = 0.010,
    fill: FillSettings | None = None,
    order: Order = "writing",
    start: tuple[float, float] | None = None,
    column: float = WIDTH,
) -> Strokes:
    """The strokes of a drawing in canvas metres (S1 section III-B), in points at most `spacing` [m] apart.

    radius: of the brush [m]. fill: how areas are painted. order "writing": column by column, at most `column`
    [m] wide, from the left, further colours from the side where the last one ended; in each column from the
    top on to the nearest end, improved by 2-opt. Lines are painted whole, in the column where they begin;
    what fills areas is cut where columns meet. But as "shortest" where the base has to drive less for that.
    "shortest": the whole drawing as one column, from the line nearest to `start` (default: the top left
    corner); for a drawing of lines, travel is never longer than in the file's order. "file": lines as they
    were drawn, which is how handwriting is kept, then areas. But for "file", lines whose ends meet are
    joined. A drawing without a line of 1 mm is an InputError.
    """
    fill = fill or FillSettings()
    _check(spacing, radius, order, column)
    fill.check()
    drawing = outlined(drawing) if fill.style == "outline" else drawing
    passes, dropped = [], 0
    for k in range(len(drawing.colours)):
        lines = [
            line for line, colour in zip(drawing.lines, drawing.line_colours, strict=True) if colour == k
        ]
        filling = fill_strokes([area for area in drawing.areas if area.colour == k], radius, fill)
        lines = join_lines(lines) if lines and order != "file" else lines
        kept = [line for line in lines if polyline_length(line) >= _DOT]
        dropped += len(lines) - len(kept)
        filling = [line for line in filling if polyline_length(line) >= _DOT]
        passes.append(_ordered(kept, filling, order, _begin(passes, drawing, start), column))
    if not any(passes):
        raise InputError(
            f"{drawing.name}: found no line longer than 1 mm; allowed is a larger canvas or drawing"
        )
    return _strokes(passes, spacing, dropped)


def _check(spacing: float, radius: float, order: str, column: float):
    lengths = {"spacing": spacing, "brush radius": radius, "column": column}
    for name, length in lengths.items():
        if not (np.isfinite(length) and length > 0):
            raise InputError(f"{name}: found {length}; allowed is a positive length in metres")
    if order not in get_args(Order):
        raise InputError(f"order: found '{order}'; allowed are {', '.join(get_args(Order))}")


def _begin(passes: list[list[Polyline]], drawing: Drawing, start) -> np.ndarray:
    """Where the next pass may best begin: where the last one ended, the first at the top left."""
    painted_before = [lines for lines in passes if lines]
    if painted_before:
        return painted_before[-1][-1][-1]
    lower, upper = drawing.bounds
    return np.array([lower[0], upper[1]] if start is None else start)


def _ordered(
    lines: list[Polyline],
    filling: list[Polyline],
    order: Order,
    start: np.ndarray,
    column: float,
) -> list[Polyline]:
    """The lines of one colour as they are painted."""
    if not (lines or filling):
        return []
    if order == "file":
        return lines + filling
    shortest = _shortest(lines + filling, start)
    if order == "shortest":
        return shortest
    # A pass that finds the robot on the right goes to the left: a base that drives back loses its place.
    u = np.concatenate(lines + filling)[:, 0]
    flip = np.array([-1.0, 1.0]) if start[0] > (u.min() + u.max()) / 2 else np.ones(2)
    written = [
        line * flip for line in _written([x * flip for x in lines], [x * flip for x in filling], column)
    ]
    # Long lines, which are painted whole, make a base go back for each column.
    return written if base_travel(written) < base_travel(shortest) else shortest


def _written(lines: list[Polyline], filling: list[Polyline], column: float) -> list[Polyline]:
    """Column by column from the left."""
    among = columns(lines + filling, column)
    return in_columns(lines, [part for line in filling for part in cut(line, among)], among)


def _shortest(lines: list[Polyline], start: np.ndarray) -> list[Polyline]:
    """From the line nearest to the start on; improved from the file's order where that was shorter."""
    nearest = painted(lines, shortened(lines, greedy_route(lines, start)))
    if travel(nearest) <= travel(lines):
        return nearest
    return painted(lines, shortened(lines, file_route(lines)))


def _strokes(passes: list[list[Polyline]], spacing: float, dropped: int) -> Strokes:
    sampled = [resample(line, spacing) for lines in passes for line in lines]
    stroke = np.repeat(np.arange(len(sampled), dtype=np.int32), [len(points) for points in sampled])
    colour = np.repeat(np.arange(len(passes), dtype=np.int32), [len(lines) for lines in passes])
    length = sum(polyline_length(points) for points in sampled)
    return Strokes(np.concatenate(sampled), stroke, colour, length, travel(sampled), dropped)
