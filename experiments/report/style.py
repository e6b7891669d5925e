"""One look for all figures, without the global state of pyplot."""

import io
from typing import Any

import matplotlib
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

WIDTH = 10.0
"""Inches across a page: 1,000 px at the density a screen shows."""
SCREEN, SHARP = 100, 180
"""Dots per inch as shown, and as rendered for pictures of dots."""

INK, SOFT, GRID = "#1d2733", "#5b6875", "#dde3e8"
PAINT, TRAVEL, BASE = "#1f5fbf", "#c9761a", "#4a4f57"
MISSED, EXCESS, COVERED = "#d64545", "#e8a33d", "#2e7d6b"

LOOK: Any = {
    "font.size": 10,
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "axes.titlesize": 11,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.titlepad": 8,
    "axes.labelcolor": SOFT,
    "axes.edgecolor": SOFT,
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": GRID,
    "grid.linewidth": 0.7,
    "text.color": INK,
    "xtick.color": SOFT,
    "ytick.color": SOFT,
    "lines.linewidth": 1.6,
    "lines.solid_capstyle": "round",
    "legend.frameon": False,
    "figure.dpi": SCREEN,
    "svg.fonttype": "path",
    "svg.hashsalt": "jaxpaint",
}


def look():
    """The context in which a figure is made and written."""
    return matplotlib.rc_context(LOOK)


def new_figure(height: float, width: float = WIDTH) -> Figure:
    """An empty figure [inches] that arranges its axes itself; to be used inside `look`."""
    figure = Figure(figsize=(width, height), layout="constrained")
    figure.get_layout_engine().set(w_pad=0.08, h_pad=0.06, wspace=0.03, hspace=0.03)  # pyright: ignore
    return figure


def to_png(figure: Figure) -> bytes:
    """The figure as dots: for pictures, and for drawings of thousands of lines."""
    held = io.BytesIO()
    FigureCanvasAgg(figure).print_figure(held, format="png", dpi=SHARP, metadata={"Software": None})
    return held.getvalue()


def to_svg(figure: Figure) -> bytes:
    """The figure as lines: for plots. The same figure gives the same bytes."""
    held = io.BytesIO()
    FigureCanvasAgg(figure).print_figure(held, format="svg", metadata={"Date": None, "Creator": None})
    return held.getvalue()
