"""The report of two runs side by side."""

import base64
import io
import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from experiments.comparison import Row, Run
from experiments.report.page import Figure, Page, Section, Tile
from experiments.report.scores import SCORES, Score, values_of
from experiments.report.settings import settings
from experiments.report.style import INK, PAINT, TRAVEL, look, new_figure, to_png, to_svg
from experiments.tables import Table, in_words

_PICTURE = re.compile(r'src="data:image/png;base64,([A-Za-z0-9+/=]+)"')
_COLOURS = (PAINT, TRAVEL)
_ACROSS = 3


def build_page(
    a: Run, b: Run, tables: tuple[Table, ...], rows: Sequence[Row], summary: Mapping[str, Any]
) -> Page:
    """Verdict, the first picture of both reports, scores over worlds, and the tables."""
    sections = [Section("Options and figures", "A: " + _words(a) + ". B: " + _words(b) + ".", (), tables)]
    pictures = [first_picture(run) for run in (a, b)]
    if all(pictures):
        figure = side_by_side([picture for picture in pictures if picture])
        sections.insert(0, Section("Pictures", "", (figure,)))
    if a.worlds and b.worlds:
        drawn = distributions(a.worlds, b.worlds)
        sections += [Section("All worlds", "", (drawn,))] if drawn else []
    clear = [row for row in rows if row.low is not None and row.high is not None and row.low * row.high > 0]
    verdict = f"{len(clear)} of {sum(row.low is not None for row in rows)} scores differ clearly"
    return Page(
        title=f"jaxpaint compare: {a.folder.name} and {b.folder.name}",
        verdict=verdict if any(row.low is not None for row in rows) else f"{len(rows)} figures side by side",
        mood="good",
        tiles=tuple(_tile(row) for row in clear[:6]),
        sections=(*sections, settings(summary)),
        footer="A score differs clearly where the 95 % interval of B - A (worlds resampled) is free of zero.",
    )


def first_picture(run: Run) -> bytes | None:
    """The first picture of dots in the run's report.html: what was painted; None where there is none."""
    try:
        found = _PICTURE.search((run.folder / "report.html").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return base64.b64decode(found[1]) if found else None


def side_by_side(pictures: Sequence[bytes]) -> Figure:
    """Pictures (PNG) in one row."""
    import matplotlib.image

    images = [matplotlib.image.imread(io.BytesIO(picture), format="png") for picture in pictures]
    tallest = max(image.shape[0] / image.shape[1] for image in images)
    with look():
        figure = new_figure(5 * tallest + 0.4)
        for axes, image, name in zip(figure.subplots(1, len(images)), images, "AB", strict=True):
            axes.imshow(image, interpolation="antialiased")
            axes.set_title(name)
            axes.set_axis_off()
        return Figure(to_png(figure), "The first picture of each run's own report: A left, B right.")


def distributions(a: Mapping[str, np.ndarray], b: Mapping[str, np.ndarray]) -> Figure | None:
    """A panel a score that both have: every world as a dot, A above B, with the medians."""
    scores = [score for score in SCORES if score.spread and score.column in a and score.column in b]
    if not scores:
        return None
    rows = -(-len(scores) // _ACROSS)
    with look():
        figure = new_figure(1.7 * rows + 0.1)
        panels = list(figure.subplots(rows, _ACROSS, squeeze=False).flat)
        for panel, score in zip(panels, scores, strict=False):
            _draw(panel, score, (values_of(a, score), values_of(b, score)))
        for spare in panels[len(scores) :]:
            spare.set_axis_off()
        image = to_svg(figure)
    return Figure(image, "Every dot is a world, A above B; the lines are the medians.")


def _draw(axes, score: Score, both: tuple[np.ndarray, np.ndarray]) -> None:
    axes.set_title(score.name, fontsize=10)
    axes.set(xlabel=f"[{score.unit}]" if score.unit else "", ylim=(-0.6, 1.6))
    axes.set_yticks([1, 0], ["A", "B"])
    axes.grid(axis="y", visible=False)
    for place, values, colour in zip((1, 0), both, _COLOURS, strict=True):
        values = values[np.isfinite(values)]
        if len(values):
            spread = 0.25 * np.sin(2.4 * np.arange(len(values)))  # apart, and the same each time
            axes.plot(values, place + spread, ".", color=colour, markersize=4, alpha=0.6)
            axes.plot([np.median(values)] * 2, [place - 0.42, place + 0.42], color=INK)


def _tile(row: Row) -> Tile:
    return Tile(
        row.name, in_words(row.difference), f"B - A; 95 %: {in_words(row.low)} to {in_words(row.high)}"
    )


def _words(run: Run) -> str:
    worlds = run.summary.get("worlds")
    words = f"{run.folder}, seed {run.summary.get('seed')}"
    return words if worlds is None else f"{words}, {worlds} worlds"
