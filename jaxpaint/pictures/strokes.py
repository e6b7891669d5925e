"""Ordered strokes: whole lines, begun at the top left as a person would, with little travel between them."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float, Int

from jaxpaint.errors import InputError
from jaxpaint.pictures.drawing import Drawing, polyline_length
from jaxpaint.pictures.joining import join_lines
from jaxpaint.pictures.resampling import resample
from jaxpaint.pictures.routes import file_route, greedy_route, painted, shortened, travel

_DOT = 1e-3  # [m]: a brush 20 mm wide makes no line of it


@dataclass(frozen=True, eq=False)
class Strokes:
    """Pen-down points in the order in which they are painted.

    points: canvas metres, u to the right and v up. stroke: the stroke of each point, counted from 0. length:
    of all strokes [m]. travel: from the end of each stroke to the start of the next [m]. dropped: lines left
    out because they are shorter than 1 mm.
    """

    points: Float[np.ndarray, "points 2"]
    stroke: Int[np.ndarray, " points"]
    length: float
    travel: float
    dropped: int

    @property
    def count(self) -> int:
        """How many strokes there are."""
        return int(self.stroke[-1]) + 1


def plan_strokes(
    drawing: Drawing,
    spacing: float,
    *,
    order: Literal["shortest", "file"] = "shortest",
    start: tuple[float, float] | None = None,
) -> Strokes:
    """The strokes of a drawing in canvas metres (S1 section III-B), in points at most `spacing` [m] apart.

    order "shortest": lines whose ends meet are joined, then ordered from the one nearest to `start` (default:
    the top left corner of the drawing) by greedy nearest end and 2-opt; travel is never longer than in the
    file's order. "file": lines as they were drawn, which is how handwriting is kept. A drawing without a line
    of 1 mm is an InputError.
    """
    if not (np.isfinite(spacing) and spacing > 0):
        raise InputError(f"spacing: found {spacing}; allowed is a positive length in metres")
    if order not in ("shortest", "file"):
        raise InputError(f"order: found '{order}'; allowed are 'shortest' and 'file'")
    lines = join_lines(list(drawing.lines)) if order == "shortest" else list(drawing.lines)
    kept = [line for line in lines if polyline_length(line) >= _DOT]
    if not kept:
        raise InputError(
            f"{drawing.name}: found no line longer than 1 mm; allowed is a larger canvas or drawing"
        )
    if order == "shortest":
        lower, upper = drawing.bounds
        kept = _ordered(kept, np.array([lower[0], upper[1]] if start is None else start))
    return _strokes(kept, spacing, dropped=len(lines) - len(kept))


def _ordered(lines: list[np.ndarray], start: np.ndarray) -> list[np.ndarray]:
    """From the line nearest to the start on; improved from the file's order where that was shorter."""
    nearest = painted(lines, shortened(lines, greedy_route(lines, start)))
    if travel(nearest) <= travel(lines):
        return nearest
    return painted(lines, shortened(lines, file_route(lines)))


def _strokes(lines: list[np.ndarray], spacing: float, dropped: int) -> Strokes:
    sampled = [resample(line, spacing) for line in lines]
    stroke = np.repeat(np.arange(len(sampled), dtype=np.int32), [len(points) for points in sampled])
    length = sum(polyline_length(points) for points in sampled)
    return Strokes(np.concatenate(sampled), stroke, length, travel(sampled), dropped)
