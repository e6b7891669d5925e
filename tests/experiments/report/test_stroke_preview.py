"""The preview shows the ink pale, the strokes over it, and the numbers that a person asks for."""

import itertools

import cv2
import numpy as np
import pytest
import shapely
from matplotlib.collections import LineCollection

from experiments.report import stroke_preview as module
from experiments.report.stroke_preview import stroke_preview
from jaxpaint.pictures import Drawing, plan_strokes
from jaxpaint.pictures.regions import areas_of


@pytest.fixture
def drawn(monkeypatch):
    """The axes that were drawn instead of their pixels."""
    held = []
    monkeypatch.setattr(module, "to_png", lambda figure: held.append(figure.axes[0]) or b"")

    def draw(strokes, drawing, **settings):
        stroke_preview(strokes, drawing, radius=0.010, **settings)
        return held[-1]

    return draw


def lines_of(colour: float, *heights: float) -> Drawing:
    lines = tuple(np.array([[0.0, height], [0.6, height]]) for height in heights)
    return Drawing(lines, (0,) * len(lines), (), ((colour, 0.0, 0.0),), "lines")


def test_travel_is_drawn_from_each_end_to_the_next_start(drawn):
    drawing = lines_of(1.0, 0.0, 0.2, 0.5)
    strokes = plan_strokes(drawing, 0.005)
    axes = drawn(strokes, drawing)
    expected = [np.stack([a[-1], b[0]]) for a, b in itertools.pairwise(strokes.lines)]
    shown = [entry.get_segments() for entry in axes.collections if isinstance(entry, LineCollection)]
    assert sum(len(s) == 2 and np.allclose(s, expected) for s in shown) == 1
    assert sum(len(s) == 3 and all(map(np.array_equal, s, strokes.lines)) for s in shown) == 1


def test_the_first_strokes_of_a_column_are_numbered_at_their_starts(drawn):
    drawing = lines_of(1.0, 0.0, 0.1, 0.2, 0.3, 0.4)
    strokes = plan_strokes(drawing, 0.005)
    axes = drawn(strokes, drawing, column=2.0)
    assert [text.get_text() for text in axes.texts] == ["1", "2", "3"]
    for text, line in zip(axes.texts, strokes.lines, strict=False):
        np.testing.assert_array_equal(text.xy, line[0])


def test_a_preview():
    areas = (*areas_of(shapely.box(0, 0, 0.3, 0.3), 0), *areas_of(shapely.box(0.5, 0, 0.8, 0.3), 1))
    line = np.array([[0.0, 0.4], [0.8, 0.4]])
    drawing = Drawing((line,), (1,), areas, ((1.0, 0.0, 0.0), (0.0, 0.0, 0.0)), "two")
    strokes = plan_strokes(drawing, 0.005)
    png = stroke_preview(strokes, drawing, radius=0.010)
    picture = cv2.imdecode(np.frombuffer(png, np.uint8), cv2.IMREAD_COLOR)
    assert picture is not None and picture.shape[1] >= 1500
    blue, green, red = (picture[..., k].astype(int) for k in range(3))
    pale = (red > 240) & (abs(green - blue) < 4) & (green > 150) & (green < 230)
    dark_first = (blue > red + 15) & (blue < 140) & (green < 80)  # the first colours of viridis
    bright_last = (red > 180) & (green > 200) & (blue < 90)
    assert pale.mean() > 0.05 and dark_first.mean() > 1e-4 and bright_last.mean() > 2e-5
    assert stroke_preview(strokes, drawing, radius=0.010) == png
