"""The brush path on the surface in space, with a plan view."""

import dataclasses
import itertools
from collections.abc import Sequence
from typing import Any

import numpy as np
from jaxtyping import Bool, Float
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from mpl_toolkits.mplot3d import Axes3D
from mpl_toolkits.mplot3d.art3d import Line3DCollection
from mpl_toolkits.mplot3d.proj3d import proj_transform

from experiments.report.page import Figure
from experiments.report.runs import runs
from experiments.report.style import BASE, PAINT, SOFT, TRAVEL, look, new_figure, to_png

BRUSHES = 60
"""Brush directions shown."""
BRUSH_LENGTH = 0.12
"""Length of a brush direction as drawn [m]."""
FILLED = 0.86
"""Share of the picture in space that is drawn on at most; the rest is for the labels of the axes."""
LARGEST_ZOOM = 1.3
"""Of the picture in space, where it is small in both directions."""
PATCHES = 60
"""Patches of the surface along each side, at most."""


@dataclasses.dataclass(frozen=True)
class SurfacePath:
    """A path in the map frame: brush positions p_map [m], outward unit normals, and whether the pen is down.

    surface: a grid of points on the wall [m]; points that are not finite are holes. base: positions of the
    robot's base on the floor [m], or no rows.
    """

    p_map: Float[np.ndarray, "samples 3"]
    normal: Float[np.ndarray, "samples 3"]
    pen: Bool[np.ndarray, " samples"]
    surface: Float[np.ndarray, "rows columns 3"]
    base: Float[np.ndarray, "steps 2"] = dataclasses.field(default_factory=lambda: np.zeros((0, 2)))


def surface_path(path: SurfacePath, caption: str = "") -> Figure:
    """The path in space, seen from beside the robot, and from above."""
    with look():
        figure = new_figure(5.0)
        grid = figure.add_gridspec(1, 3, width_ratios=(0.3, 3, 2))  # the left end is for the label of z
        space: Axes3D = figure.add_subplot(grid[1], projection="3d", computed_zorder=False)  # pyright: ignore
        _draw_space(space, path)
        _draw_plan(figure.add_subplot(grid[2]), path)
        figure.legend(handles=_legend(path), loc="outside lower center", ncols=5)
        image = to_png(figure)
    return Figure(
        image,
        caption or "The planned path on the surface in the map frame, from beside the robot and from above.",
    )


def strokes(path: SurfacePath, down: bool) -> list[np.ndarray]:
    """Runs of samples [n, 3] with the pen down (or up), with the samples that join them to the next run."""
    reach = 0 if down else 1  # travel starts where the stroke before it ended
    return [
        path.p_map[max(0, start - reach) : stop + reach]
        for start, stop in runs(path.pen if down else ~path.pen)
    ]


def brushes(path: SurfacePath) -> tuple[np.ndarray, np.ndarray]:
    """Positions and directions into the wall [n, 3] of a few samples with the pen down."""
    down = np.flatnonzero(path.pen)
    some = down[:: max(1, len(down) // BRUSHES)]
    return path.p_map[some], -path.normal[some]


def _draw_space(axes: Axes3D, path: SurfacePath) -> None:
    rows, columns = (max(1, size // PATCHES) for size in path.surface.shape[:2])
    surface = path.surface[::rows, ::columns]
    axes.plot_surface(
        *np.moveaxis(surface, -1, 0), rstride=1, cstride=1, color="#e9e4d8", edgecolor="#d5cfc0",
        linewidth=0.25, shade=True, zorder=1,
    )  # fmt: skip
    tips, directions = brushes(path)
    tails = tips - BRUSH_LENGTH * directions
    _draw_lines(axes, strokes(path, down=False), colors=TRAVEL, linewidths=0.8, zorder=2, linestyles="--")
    _draw_lines(axes, np.stack([tails, tips], 1), colors=SOFT, linewidths=0.7, zorder=3)
    _draw_lines(axes, strokes(path, down=True), colors=PAINT, linewidths=1.8, zorder=4)
    if len(path.base):
        axes.plot(*path.base.T, 0.0, color=BASE, linewidth=1.6, zorder=2)
    _frame_space(axes, path, tails)


def _draw_lines(axes: Axes3D, lines: Sequence[np.ndarray] | np.ndarray, **how: Any) -> None:
    if len(lines):  # an empty collection has no extent, which matplotlib asks for
        axes.add_collection3d(Line3DCollection(list(lines), **how))


def _frame_space(axes: Axes3D, path: SurfacePath, tails: np.ndarray) -> None:
    """Equal scales around everything that is drawn, looked at from the robot's side."""
    floor = np.column_stack([path.base, np.zeros(len(path.base))])
    drawn = np.concatenate([path.surface.reshape(-1, 3), path.p_map, tails, floor])
    drawn = drawn[np.isfinite(drawn).all(axis=1)]
    low, high = drawn.min(axis=0), drawn.max(axis=0)
    span = np.maximum(high - low, 0.1)
    for limits, start, length in zip((axes.set_xlim, axes.set_ylim, axes.set_zlim), low, span, strict=True):
        limits(start, start + length)
    axes.view_init(elev=20, azim=-150)
    axes.set_box_aspect(span)
    axes.set_box_aspect(span, zoom=min(LARGEST_ZOOM, FILLED / _reach(axes, low, low + span)))
    axes.set(xlabel="x [m]", ylabel="y [m]", zlabel="z [m]")
    for axis, length in zip((axes.xaxis, axes.yaxis, axes.zaxis), span, strict=True):
        axis.set_major_locator(_ticks(length))
        axis.set_pane_color((1, 1, 1, 0))


def _reach(axes: Axes3D, low: np.ndarray, high: np.ndarray) -> float:
    """How far a box [m] goes out of the middle of the picture, 1 at its border; a tall one goes beyond it."""
    corners = np.array(list(itertools.product(*zip(low, high, strict=True))))
    across, up, _ = proj_transform(*corners.T, axes.get_proj())
    left, bottom, right, top = axes.viewLim.extents
    halves = (0.5 * (right - left), 0.5 * (top - bottom))
    middles = (0.5 * (right + left), 0.5 * (top + bottom))
    places = zip((across, up), middles, halves, strict=True)
    return max(float(np.abs(np.asarray(x) - middle).max() / half) for x, middle, half in places)


def _ticks(span: float):
    from matplotlib.ticker import MaxNLocator

    return MaxNLocator(2 if span < 1.0 else 5)


def _draw_plan(axes: Axes, path: SurfacePath) -> None:
    """From above, the robot below the wall: x upwards, y to the left."""
    row = path.surface[path.surface.shape[0] // 2]
    axes.plot(row[:, 1], row[:, 0], color="#b9b09a", linewidth=4, solid_capstyle="butt")
    tips, directions = brushes(path)
    tails = tips - BRUSH_LENGTH * directions
    axes.plot([tails[:, 1], tips[:, 1]], [tails[:, 0], tips[:, 0]], color=SOFT, linewidth=0.7)
    for run in strokes(path, down=False):
        axes.plot(run[:, 1], run[:, 0], color=TRAVEL, linewidth=0.8, linestyle="--")
    for run in strokes(path, down=True):
        axes.plot(run[:, 1], run[:, 0], color=PAINT, linewidth=1.8)
    if len(path.base):
        axes.plot(path.base[:, 1], path.base[:, 0], color=BASE)
    axes.set(xlabel="y [m]", ylabel="x [m]", title="From above", aspect="equal")
    axes.invert_xaxis()


def _legend(path: SurfacePath) -> list[Line2D]:
    entries = [
        Line2D([], [], color=PAINT, label="pen down"),
        Line2D([], [], color=TRAVEL, linewidth=0.8, linestyle="--", label="pen up"),
        Line2D([], [], color=SOFT, linewidth=0.7, label="brush direction"),
        Line2D([], [], color="#b9b09a", linewidth=4, label="surface"),
    ]
    return entries + ([Line2D([], [], color=BASE, label="base")] if len(path.base) else [])
