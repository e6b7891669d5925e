"""The halting study as a picture: error, starts and time against Theta."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from experiments.report.style import EXCESS, PAINT, TRAVEL, look, new_figure
from experiments.tracking.halting import THETAS, Cell

if TYPE_CHECKING:
    from experiments.reproduce.halting import CellResult

_COLOURS = (TRAVEL, PAINT, EXCESS)
_SHOWN = (("error", 1e3, "error [mm]"), ("starts", 1, "base starts"), ("time", 1, "time [s]"))


def halting_figure(results: "Mapping[Cell, CellResult]") -> Figure:
    """A column for each picture, with and without looking; a line for each speed, the rival beside it."""
    columns = list(dict.fromkeys((cell.looking, cell.picture) for cell in results))
    with look():
        figure = new_figure(7.5)
        axes = figure.subplots(len(_SHOWN), len(columns), squeeze=False, sharex=True)
        for column, (looking, picture) in enumerate(columns):
            cells = [cell for cell in results if (cell.looking, cell.picture) == (looking, picture)]
            for row, (name, scale, label) in enumerate(_SHOWN):
                _draw(axes[row, column], {cell: results[cell] for cell in cells}, name, scale)
                axes[row, column].set_ylim(bottom=0)
                if column == 0:
                    axes[row, 0].set_ylabel(label)
            axes[0, column].set_title(f"{picture}, {'looking' if looking else 'odometry alone'}")
            _name_places(axes[-1, column])
        lines, labels = axes[0, 0].get_legend_handles_labels()
        figure.legend(lines, labels, loc="outside upper right", ncols=len(labels))
    return figure


def _draw(axes: Axes, results: "Mapping[Cell, CellResult]", name: str, scale: float) -> None:
    for colour, (cell, result) in zip(_COLOURS, results.items(), strict=False):
        points = [getattr(result.thetas[theta], name) for theta in THETAS]
        label = f"{1e3 * cell.speed:.0f} mm/s"
        _marks(axes, range(len(points)), points, scale, colour, label, "o-")
        _marks(axes, [len(THETAS)], [getattr(result.parked, name)], scale, colour, None, "s")


def _marks(axes: Axes, places, points, scale: float, colour: str, label: str | None, style: str) -> None:
    """Medians with their intervals; what is not finite is left out."""
    values = scale * np.asarray(points, float)
    values[~np.isfinite(values).all(1)] = np.nan
    middle, low, high = values.T
    axes.errorbar(
        list(places), middle, yerr=[middle - low, high - middle], fmt=style, color=colour, label=label, ms=4
    )


def _name_places(axes: Axes) -> None:
    names = [f"{theta:g}" if theta < 1e9 else "∞" for theta in THETAS]
    axes.set_xticks(range(len(THETAS) + 1), [*names, "parks"])
    axes.set_xlabel("Theta [m]")
