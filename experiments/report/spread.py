"""How scores spread over the worlds."""

import dataclasses

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes

from experiments.report.page import Figure
from experiments.report.style import BASE, PAINT, SOFT, look, new_figure, to_svg

ACROSS = 3
"""Panels in a row."""


@dataclasses.dataclass(frozen=True)
class Spread:
    """One score of every world, in the unit that a person reads; not finite where a world has none.

    bound: a value that the score is held against, None for none.
    """

    name: str
    unit: str
    values: Float[np.ndarray, " worlds"]
    bound: float | None = None


def spread(scores: tuple[Spread, ...]) -> Figure:
    """A panel a score: every world as a dot over its histogram, with median and 5 to 95 %."""
    rows = -(-len(scores) // ACROSS)
    with look():
        figure = new_figure(1.9 * rows + 0.1)
        panels = list(figure.subplots(rows, ACROSS, squeeze=False).flat)
        for panel, score in zip(panels, scores, strict=False):
            _draw(panel, score)
        for spare in panels[len(scores) :]:
            spare.set_axis_off()
        image = to_svg(figure)
    return Figure(
        image, "Every dot is a world; the line is the median, the bar spans 5 to 95 % of the worlds."
    )


def _draw(axes: Axes, score: Spread) -> None:
    values = score.values[np.isfinite(score.values)]
    missing = len(score.values) - len(values)
    axes.set_title(score.name + (f" ({missing} without)" if missing else ""), fontsize=10)
    axes.set(xlabel=f"[{score.unit}]" if score.unit else "", yticks=[], ylim=(-0.62, 1.08))
    axes.spines["left"].set_visible(False)
    axes.grid(axis="y", visible=False)
    if len(values):
        _draw_histogram(axes, values)
        _draw_dots(axes, values)
    if score.bound is not None:
        axes.axvline(score.bound, color=SOFT, linestyle=":", linewidth=1.2)


def _draw_histogram(axes: Axes, values: np.ndarray) -> None:
    middle = float(np.median(values))
    least = max(abs(middle) * 1e-3, 1e-9)  # equal values would have a histogram without width
    low, high = float(values.min()), float(values.max())
    if high - low < least:
        low, high = middle - least, middle + least
    counts, edges = np.histogram(values, bins=min(24, max(6, len(values) // 3)), range=(low, high))
    axes.bar(
        edges[:-1], counts / counts.max(), np.diff(edges), align="edge", color=PAINT, alpha=0.25, linewidth=0
    )


def _draw_dots(axes: Axes, values: np.ndarray) -> None:
    # Heights by golden-ratio steps: spread evenly, and the same every time.
    heights = -0.14 - 0.26 * ((np.arange(len(values)) * 0.6180339887) % 1.0)
    axes.scatter(values, heights, s=9, color=PAINT, alpha=0.6, linewidths=0)
    low, middle, high = np.quantile(values, (0.05, 0.5, 0.95))
    axes.plot((low, high), (-0.52, -0.52), color=BASE, linewidth=2.2)
    axes.plot((middle, middle), (-0.6, 1.0), color=BASE, linewidth=1.3)
