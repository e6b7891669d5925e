"""How far the brush is from its plan over time, over all worlds."""

import dataclasses

import numpy as np
from jaxtyping import Bool, Float
from matplotlib.axes import Axes

from experiments.report.page import Figure
from experiments.report.runs import runs
from experiments.report.style import BASE, PAINT, SOFT, look, new_figure, to_svg

SAMPLES = 1500
"""Samples drawn, at most: more than the page has dots across."""


@dataclasses.dataclass(frozen=True)
class TrackingError:
    """Distance of the true brush from the planned path, time-matched, in quantiles over worlds.

    time [s]; low, median, high: 5th, 50th and 95th percentile [m], not finite where no world is live;
    pen: is the plan's pen down? halted: share of the worlds whose base is halted.
    """

    time: Float[np.ndarray, " samples"]
    low: Float[np.ndarray, " samples"]
    median: Float[np.ndarray, " samples"]
    high: Float[np.ndarray, " samples"]
    pen: Bool[np.ndarray, " samples"]
    halted: Float[np.ndarray, " samples"]


def tracking_error(error: TrackingError) -> Figure:
    """Median and band over time; below it when the base stands still."""
    error = _thinned(error)
    with look():
        figure = new_figure(4.2)
        above, below = figure.subplots(2, 1, sharex=True, height_ratios=(4, 1))
        _draw_error(above, error)
        _draw_halts(below, error)
        image = to_svg(figure)
    caption = (
        "Distance of the true brush from the planned path over simulated time, in all worlds; pen-up travel "
        "(shaded) is not scored. Below: the share of worlds whose base is halted."
    )
    return Figure(image, caption)


def _draw_error(axes: Axes, error: TrackingError) -> None:
    low, median, high = (np.where(error.pen, x * 1e3, np.nan) for x in (error.low, error.median, error.high))
    axes.fill_between(error.time, low, high, color=PAINT, alpha=0.2, linewidth=0, label="5 to 95 % of worlds")
    axes.plot(error.time, median, color=PAINT, label="median", linewidth=1.3)
    _shade_travel(axes, error)
    axes.set(
        ylabel="error [mm]",
        title="Tracking error",
        xlim=(error.time[0], max(error.time[-1], error.time[0] + 1e-3)),
        ylim=(0, _top(error)),
    )
    axes.legend(loc="upper left", bbox_to_anchor=(0.55, 1.17), ncols=3, borderaxespad=0)


def _top(error: TrackingError) -> float:
    """The upper end of the scale [mm]."""
    scored = error.high[error.pen & np.isfinite(error.high)]
    return max(float(scored.max()) * 1.1e3 if len(scored) else 1.0, 1.0)


def _draw_halts(axes: Axes, error: TrackingError) -> None:
    axes.fill_between(error.time, 0, error.halted * 100, step="mid", color=BASE, alpha=0.75, linewidth=0)
    axes.set(xlabel="time [s]", ylabel="halted [%]", ylim=(0, 100), yticks=(0, 50, 100))


def _shade_travel(axes: Axes, error: TrackingError) -> None:
    last = len(error.time) - 1
    for number, (start, stop) in enumerate(runs(~error.pen)):
        ends = float(error.time[start]), float(error.time[min(stop, last)])
        axes.axvspan(*ends, color=SOFT, alpha=0.13, linewidth=0, label="pen up" if number == 0 else None)


def _thinned(error: TrackingError) -> TrackingError:
    step = max(1, -(-len(error.time) // SAMPLES))
    return TrackingError(*(getattr(error, field.name)[::step] for field in dataclasses.fields(error)))
