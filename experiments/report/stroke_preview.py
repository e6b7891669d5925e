"""A picture of the strokes over the ink, in the order in which they are painted."""

from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.lines import Line2D
from matplotlib.patches import PathPatch
from matplotlib.path import Path as Outline

from experiments.report.style import INK, SOFT, WIDTH, look, new_figure, to_png
from jaxpaint.pictures import Drawing, Strokes

_ORDER = "viridis"
_NUMBERED = 3  # strokes with a number at the head of each column
_PALE = 0.25  # of the ink's own colour; the rest is white
_TALLEST = 14.0  # inches


def stroke_preview(strokes: Strokes, drawing: Drawing, *, radius: float, column: float = 0.4) -> bytes:
    """The strokes of a drawing in canvas metres as a PNG: a page to look at before the robot starts.

    Under them the ink in its own colours, pale (lines widened to the brush); the strokes from dark to bright
    as they follow each other, with a dot where each starts; numbers for the first strokes of each column of
    so many metres; thin grey lines where the brush travels with the pen up.
    """
    lower, upper = drawing.bounds
    width, height = (upper - lower) + 4 * radius
    with look():
        tall = min(_TALLEST, WIDTH * height / width + 1.2)
        figure = new_figure(tall)
        axes = figure.add_subplot()
        axes.set_aspect("equal")
        axes.set_xlim(lower[0] - 2 * radius, upper[0] + 2 * radius)
        axes.set_ylim(lower[1] - 2 * radius, upper[1] + 2 * radius)
        _draw_ink(axes, drawing, radius, (WIDTH, tall))
        _draw_strokes(axes, strokes)
        _number(axes, strokes, column)
        axes.set_title(f"{drawing.name}: {_summary(strokes)}")
        axes.set_xlabel("u [m]")
        axes.set_ylabel("v [m]")
        figure.legend(handles=_legend(), loc="outside lower center", ncols=3)
        return to_png(figure)


def _draw_ink(axes: Axes, drawing: Drawing, radius: float, figure_size: tuple[float, float]) -> None:
    """Areas, and lines as wide as the brush."""
    pale = [tuple(1 - _PALE * (1 - c) if sum(rgb) > 0.1 else 0.85 for c in rgb) for rgb in drawing.colours]
    for area in drawing.areas:
        outline = Outline.make_compound_path(*(Outline(ring) for ring in area.rings))
        axes.add_patch(PathPatch(outline, facecolor=pale[area.colour], edgecolor="none", zorder=1))
    points = 72.0 * _inches_per_metre(axes, figure_size)
    lines = LineCollection(
        list(drawing.lines),
        colors=[pale[colour] for colour in drawing.line_colours],
        linewidths=2 * radius * points,
        capstyle="round",
        zorder=1,
    )
    axes.add_collection(lines)


def _inches_per_metre(axes: Axes, size: tuple[float, float]) -> float:
    """Of the page, nearly: labels take about a tenth of it."""
    left, right = axes.get_xlim()
    low, high = axes.get_ylim()
    width, height = size
    return 0.9 * min(width / (right - left), (height - 1.2) / (high - low))


def _draw_strokes(axes: Axes, strokes: Strokes) -> None:
    lines = strokes.lines
    order = np.arange(len(lines))
    painted = LineCollection(lines, cmap=_ORDER, array=order, linewidths=0.9, zorder=3)
    travel = [np.stack([a[-1], b[0]]) for a, b in pairwise(lines)]
    axes.add_collection(LineCollection(travel, colors="#9aa4ad", linewidths=0.4, zorder=2))
    axes.add_collection(painted)
    starts = np.array([line[0] for line in lines])
    axes.scatter(*starts.T, c=order, cmap=_ORDER, s=7, zorder=4, linewidths=0)


def _number(axes: Axes, strokes: Strokes, column: float) -> None:
    """Small numbers beside the first strokes of each pass and column."""
    starts = np.array([line[0] for line in strokes.lines])
    block = np.floor((starts[:, 0] - starts[:, 0].min()) / column).astype(int)
    new = np.flatnonzero(np.diff(block, prepend=-1) | np.diff(strokes.colour, prepend=-1))
    last = -np.inf
    for k in new:
        if k - last < 2 * _NUMBERED:
            continue  # a stroke that begins just beyond a border is no new column
        last = k
        for i in range(k, min(k + _NUMBERED, strokes.count)):
            axes.annotate(
                str(i + 1),
                tuple(starts[i]),
                xytext=(3, 3),
                textcoords="offset points",
                fontsize=7,
                color=INK,
                zorder=5,
                bbox={"boxstyle": "round,pad=0.1", "facecolor": "white", "edgecolor": "none", "alpha": 0.7},
            )


def _summary(strokes: Strokes) -> str:
    passes = len(set(strokes.colour.tolist()))
    colours = f"{passes} pass{'es' if passes > 1 else ''}"
    return (
        f"{strokes.length:.1f} m in {strokes.count} strokes, {strokes.travel:.1f} m between them, {colours}"
    )


def _legend() -> list[Line2D]:
    return [
        Line2D(
            [], [], color="#3b528b", marker="o", markersize=4, label="stroke, from its start (dark: first)"
        ),
        Line2D([], [], color="#9aa4ad", linewidth=0.8, label="travel, pen up"),
        Line2D([], [], color=SOFT, alpha=0.35, linewidth=6, label="ink"),
    ]
