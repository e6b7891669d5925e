"""The built-in drawing makes the reference robot drive, and suits its brush, which paints 20 mm wide."""

from itertools import combinations

import numpy as np

from experiments.drawings import built_in_drawing
from jaxpaint.pictures import fit, plan_strokes, read_drawing
from jaxpaint.pictures.drawing import polyline_length

CANVAS = (2.4, 0.6)


def test_size_and_strokes():
    drawing = fit(read_drawing(built_in_drawing()), CANVAS)
    lower, upper = drawing.bounds
    np.testing.assert_allclose(upper - lower, CANVAS, atol=2e-3)
    strokes = plan_strokes(drawing, 0.005)
    assert 6.0 <= strokes.length <= 7.5
    assert 8 <= strokes.count <= 16
    assert strokes.dropped == 0 and not drawing.ignored
    assert sum(polyline_length(line) for line in drawing.lines) - strokes.length < 0.01


def test_separate_lines_are_as_far_apart_as_two_brushes():
    strokes = plan_strokes(fit(read_drawing(built_in_drawing()), CANVAS), 0.005)
    lines = [strokes.points[strokes.stroke == k] for k in range(strokes.count)]
    gaps = [np.linalg.norm(a[:, None] - b, axis=-1).min() for a, b in combinations(lines, 2)]
    assert min(gaps) >= 0.045


def test_there_is_something_to_paint_everywhere_along_the_wall():
    points = plan_strokes(fit(read_drawing(built_in_drawing()), CANVAS), 0.005).points
    shares = np.histogram(points[:, 0], bins=6, range=(-1.2, 1.2))[0] / len(points)
    assert shares.min() > 0.08


def test_it_exercises_the_reader():
    text = built_in_drawing().read_text()
    assert all(feature in text for feature in ("<g ", "transform=", " A135 135 ", "<line", " t150 0"))
