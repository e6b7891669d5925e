"""The painted wall beside the wanted picture, and what differs."""

import dataclasses

import numpy as np
from jaxtyping import Bool, Float
from matplotlib.axes import Axes
from matplotlib.colors import Colormap, LinearSegmentedColormap, ListedColormap
from matplotlib.figure import Figure as MatplotlibFigure
from matplotlib.patches import Patch

from experiments.report.colours import Palette, paint_colours, wanted_colours
from experiments.report.page import Figure
from experiments.report.style import COVERED, EXCESS, MISSED, PAINT, WIDTH, look, new_figure, to_png

MARGIN = 0.05
"""Border shown around what is painted or wanted [m]."""
WALL, NO_WALL = "#f7f5f0", "#c5cad0"


@dataclasses.dataclass(frozen=True)
class PaintedWall:
    """Paint on the surface's own (u, v) grid in one world.

    thickness: of the paint in cell (row, column) [m]; row 0 lies lowest, column 0 leftmost as the robot sees
    it. painted: cells that count as painted. lower, upper: (u, v) of the grid's outer corners [m].
    name: which world this is, such as "median world, 12". Several colours have a leading axis of both.
    """

    thickness: Float[np.ndarray, "*colours rows columns"]
    painted: Bool[np.ndarray, "*colours rows columns"]
    lower: tuple[float, float]
    upper: tuple[float, float]
    name: str


def painted_wall(
    wanted: Bool[np.ndarray, "*colours rows columns"],
    walls: tuple[PaintedWall, ...],
    surface: Bool[np.ndarray, "rows columns"] | None = None,
    palette: Palette = (),
) -> Figure:
    """The wanted picture beside the paint of the first world, then what differs in each world.

    All worlds are on the grid of `wanted`. surface: cells that lie on the wall; None for all. palette: sRGB
    of the colours [0..1] in the order of painting. One colour is drawn as depth of one tone.
    """
    shown = _window(wanted, walls)
    with look():
        figure, panels = _layout(shown, 2 + len(walls))
        _draw_wanted(panels[0], wanted, surface, shown, palette)
        _draw_paint(panels[1], walls[0], surface, shown, palette)
        for panel, wall in zip(panels[2:], walls, strict=True):
            _draw_difference(panel, wanted, wall, shown)
        figure.legend(handles=_legend(), loc="outside lower center", ncols=3)
        image = to_png(figure)
    names = " and ".join(wall.name for wall in walls)
    caption = (
        f"As the robot sees the wall: the picture as wanted on the surface, and the paint laid ({names})."
    )
    return Figure(image, caption)


@dataclasses.dataclass(frozen=True)
class _Shown:
    """The part of the grid that has something to show, and its (left, right, bottom, top) [m]."""

    rows: slice
    columns: slice
    extent: tuple[float, float, float, float]

    @property
    def aspect(self) -> float:
        left, right, bottom, top = self.extent
        return (top - bottom) / (right - left)


def _window(wanted: np.ndarray, walls: tuple[PaintedWall, ...]) -> _Shown:
    lower, upper = np.array(walls[0].lower), np.array(walls[0].upper)
    used = np.any([_any(wanted), *[_any(wall.painted) for wall in walls]], axis=0)
    shape = np.array(used.shape[::-1])
    cell = (upper - lower) / shape
    rows, columns = np.nonzero(used if used.any() else np.ones_like(used))
    first, last = np.array([columns.min(), rows.min()]), np.array([columns.max(), rows.max()])
    low = np.maximum(np.floor(first - MARGIN / cell).astype(int), 0)
    high = np.minimum(np.ceil(last + 1 + MARGIN / cell).astype(int), shape)
    (left, bottom), (right, top) = (lower + low * cell).tolist(), (lower + high * cell).tolist()
    return _Shown(slice(low[1], high[1]), slice(low[0], high[0]), (left, right, bottom, top))


def _layout(shown: _Shown, panels: int) -> tuple[MatplotlibFigure, list[Axes]]:
    """Panels in two columns, or in one row where the picture is tall."""
    columns = panels if shown.aspect > 1.5 else 2
    rows = -(-panels // columns)
    height = rows * (min((WIDTH - 0.6) / columns * shown.aspect, 6.0) + 0.5) + 0.6
    figure = new_figure(height)
    cells = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    for axes in cells[-1]:
        axes.set_xlabel("u [m]")
    for axes in cells[:, 0]:
        axes.set_ylabel("v [m]")
    axes = list(cells.flat)
    for spare in axes[panels:]:
        spare.set_axis_off()
    return figure, axes[:panels]


def _draw_wanted(axes: Axes, wanted: np.ndarray, surface, shown: _Shown, palette: Palette) -> None:
    _ground(axes, surface, shown)
    if len(palette) > 1:
        _coloured(axes, wanted_colours(wanted, palette), shown)
    else:
        _image(axes, np.where(_any(wanted), 0.0, np.nan), shown, ListedColormap(["#2b3440"]), (0, 1))
    axes.set_title("Wanted")


def _draw_paint(axes: Axes, wall: PaintedWall, surface, shown: _Shown, palette: Palette) -> None:
    """Thickness as depth of colour, full at the 98th percentile of what is painted."""
    full = float(np.quantile(wall.thickness[wall.painted], 0.98)) if wall.painted.any() else 1.0
    _ground(axes, surface, shown)
    if len(palette) > 1:
        # Paint hides what is below it long before it is as thick as where rows overlap.
        _coloured(axes, paint_colours(wall.thickness, palette, 0.5 * full), shown)
    else:
        colours = LinearSegmentedColormap.from_list("paint", ["#dbe7f8", PAINT, "#0b2a5b"])
        film = wall.thickness.reshape(wall.thickness.shape[-2:])
        _image(axes, np.where(film > 0.02 * full, film, np.nan), shown, colours, (0, full))
    axes.set_title(f"Painted, {wall.name}")


def _draw_difference(axes: Axes, wanted: np.ndarray, wall: PaintedWall, shown: _Shown) -> None:
    """Every colour by itself: what lacks its own colour is missed, be another there."""
    missed = _any(wanted & ~wall.painted)
    parts = (_any(wanted) & ~missed, missed, _any(wall.painted) & ~_any(wanted))
    states = np.full(missed.shape, np.nan)
    for state, where in enumerate(parts):
        states[where] = state
    _image(axes, states, shown, ListedColormap([COVERED, MISSED, EXCESS]), (-0.5, 2.5))
    axes.set_title(f"Difference, {wall.name}")


def _any(cells: np.ndarray) -> np.ndarray:
    """Over colours, if there are any."""
    return np.asarray(cells.any(axis=0)) if cells.ndim == 3 else cells


def _ground(axes: Axes, surface: np.ndarray | None, shown: _Shown) -> None:
    """The wall's own colour, and grey where there is no wall."""
    axes.set_facecolor(WALL)
    if surface is not None:
        _image(axes, np.where(surface, np.nan, 0.0), shown, ListedColormap([NO_WALL]), (0, 1))


def _image(
    axes: Axes, values: np.ndarray, shown: _Shown, colours: Colormap, limits: tuple[float, float]
) -> None:
    low, high = limits
    part = values[shown.rows, shown.columns]
    axes.imshow(
        part, origin="lower", extent=shown.extent, cmap=colours, vmin=low, vmax=high, interpolation="nearest"
    )
    axes.grid(False)


def _coloured(axes: Axes, picture: np.ndarray, shown: _Shown) -> None:
    part = picture[shown.rows, shown.columns]
    axes.imshow(part, origin="lower", extent=shown.extent, interpolation="nearest")
    axes.grid(False)


def _legend() -> list[Patch]:
    names = (
        (COVERED, "wanted and painted"),
        (MISSED, "wanted, not painted"),
        (EXCESS, "painted, not wanted"),
    )
    return [Patch(color=colour, label=name) for colour, name in names]
