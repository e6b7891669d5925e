"""Dots of line art are painted: those as wide as the lines as dabs, wider ones as areas."""

import cv2
import numpy as np
import pytest
from PIL import Image

from jaxpaint.errors import InputError
from jaxpaint.pictures import RasterSettings, fit, plan_strokes, read_drawing
from jaxpaint.pictures.drawing import polyline_length
from jaxpaint.pictures.regions import region_of

MIDDLES = np.array([[60 + 70 * k, 60] for k in range(6)], float)
SKELETON = RasterSettings(style="skeleton")


@pytest.fixture
def saved(tmp_path):
    def save(picture: np.ndarray):
        Image.fromarray(picture).save(tmp_path / "a.png")
        return tmp_path / "a.png"

    return save


def letters(radius: int = 5) -> np.ndarray:
    """Six times the letter i: a stem 10 pixels wide, and a dot of this radius."""
    picture = np.full((260, 480), 255, np.uint8)
    for u, v in MIDDLES.astype(int).tolist():
        cv2.line(picture, (u, v + 40), (u, v + 140), 0, 10, cv2.LINE_AA)
        cv2.circle(picture, (u, v), radius, 0, -1, cv2.LINE_AA)
    return picture


def dots_of(drawing) -> np.ndarray:
    return np.array([line.mean(axis=0) for line in drawing.lines if polyline_length(line) == 0])


def test_dots_of_letters_are_dabs_at_their_middles(saved):
    drawing = read_drawing(saved(letters()))
    assert len(drawing.lines) == 12 and not drawing.areas
    found = dots_of(drawing)
    np.testing.assert_allclose(found[found[:, 0].argsort()], (MIDDLES + 0.5) * [1, -1], atol=0.3)
    strokes = plan_strokes(fit(drawing, (1.2, 1.2)), 0.005)
    assert (strokes.count, strokes.dropped) == (12, 0)
    lengths = [polyline_length(line) for line in strokes.lines]
    assert sorted(lengths)[:6] == pytest.approx([2e-3] * 6)


def test_dots_wider_than_the_lines_are_areas(saved):
    drawing = read_drawing(saved(letters(radius=14)), SKELETON)
    assert len(drawing.lines) == 6 and len(dots_of(drawing)) == 0
    sizes = [region_of(area).area for area in drawing.areas]
    assert sizes == pytest.approx([np.pi * 14.5**2] * 6, rel=0.05)


def test_a_dash_is_a_line(saved):
    picture = letters()
    cv2.line(picture, (200, 240), (220, 240), 0, 10, cv2.LINE_AA)
    assert len(dots_of(read_drawing(saved(picture)))) == 6


@pytest.mark.parametrize("radius", [15, 20, 25])
def test_a_disc_read_as_a_line_has_no_size(saved, radius):
    picture = np.full((100, 100), 255, np.uint8)
    cv2.circle(picture, (50, 50), radius, 0, -1)
    drawing = read_drawing(saved(picture), SKELETON)
    with pytest.raises(InputError, match="a: found a single dot; allowed is"):
        fit(drawing, (1.0, 1.0))
