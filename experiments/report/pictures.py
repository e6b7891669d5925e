"""Figures as pictures in a run's folder."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from experiments.output import RunFolder


def write_pictures(folder: "RunFolder", figures: "Mapping[str, Figure]", prefix: str = "") -> None:
    """A PNG for each figure, by its name."""
    from experiments.report.style import look, to_png

    for title, figure in figures.items():
        with look():
            folder.path(f"{prefix}{title.replace(' ', '-')}.png").write_bytes(to_png(figure))
