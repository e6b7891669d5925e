"""Drawings laid onto the canvas."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jaxpaint.errors import InputError
from jaxpaint.pictures import Area, Drawing, fit

LINES = (np.array([[10.0, 50.0], [30.0, 20.0], [10.0, 50.0]]), np.array([[12.0, 18.0], [90.0, 40.0]]))
RING = np.array([[40.0, 20.0], [60.0, 20.0], [60.0, 50.0], [40.0, 20.0]])
COLOURS = ((1.0, 0.0, 0.0), (0.0, 0.0, 0.0))
DRAWING = Drawing(LINES, (0, 1), (Area((RING,), 1),), COLOURS, "two lines and an area")

sides = st.floats(0.01, 100)


@given(sides, sides)
def test_fit_fills_the_canvas_centred_with_the_aspect_kept(width, height):
    fitted = fit(DRAWING, (width, height))
    lower, upper = fitted.bounds
    np.testing.assert_allclose(lower + upper, 0, atol=1e-9)
    filled = (upper - lower) / [width, height]
    assert filled.max() == pytest.approx(1) and filled.min() <= 1 + 1e-9
    scale = fitted.length / DRAWING.length
    for before, after in zip(DRAWING.lines, fitted.lines, strict=True):
        np.testing.assert_allclose(np.diff(after, axis=0), np.diff(before, axis=0) * scale, atol=1e-9)
    (area,) = fitted.areas
    np.testing.assert_allclose(np.diff(area.rings[0], axis=0), np.diff(RING, axis=0) * scale, atol=1e-9)
    assert (fitted.line_colours, area.colour, fitted.colours) == ((0, 1), 1, COLOURS)
    assert (fitted.name, fitted.closed) == (DRAWING.name, (True, False))


def test_a_drawing_without_height_fits_by_its_width():
    level = Drawing((np.array([[2.0, 7.0], [4.0, 7.0]]),), (0,), (), ((0.0, 0.0, 0.0),), "level")
    assert fit(level, (3.0, 1.0)).lines[0].tolist() == [[-1.5, 0], [1.5, 0]]


def test_length_and_bounds():
    lines, ring = 2 * np.hypot(20, 30) + np.hypot(78, 22), 50 + np.hypot(20, 30)
    assert DRAWING.length == pytest.approx(lines + ring)
    assert [side.tolist() for side in DRAWING.bounds] == [[10, 18], [90, 50]]


@pytest.mark.parametrize("size", [(0.0, 1.0), (1.0, -1.0), (float("nan"), 1.0), (float("inf"), 1.0)])
def test_impossible_canvas(size):
    with pytest.raises(InputError, match=r"canvas size: found .* allowed"):
        fit(DRAWING, size)
