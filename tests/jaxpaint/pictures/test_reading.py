"""How much of the ink lies under the lines that were read, found without the reader."""

import cv2
import numpy as np
import pytest
from PIL import Image

from jaxpaint.pictures import RasterSettings, read_drawing
from jaxpaint.pictures.reading_measure import reading_of

SKELETON = RasterSettings(style="skeleton")


def crossing() -> tuple[np.ndarray, list[np.ndarray]]:
    """Ink of two bars 7 pixels wide and a thick one, and their middles."""
    ink = np.zeros((200, 300), np.uint8)
    ends = [((30, 40), (270, 40), 7), ((60, 20), (60, 180), 7), ((120, 140), (260, 140), 21)]
    for a, b, width in ends:
        cv2.line(ink, a, b, 1, width)
    return ink > 0, [np.array([a, b], float) for a, b, _ in ends]


def test_lines_in_the_middle_of_ink_read_all_of_it():
    ink, lines = crossing()
    found = reading_of(ink, lines)
    assert found.ink == ink.sum() and found.ink_read > 0.999 and found.lines_on_ink == 1


@pytest.mark.parametrize("lost", [0, 1, 2])
def test_a_line_that_is_lost_lowers_the_share_by_its_ink(lost):
    ink, lines = crossing()
    only = np.zeros(ink.shape, np.uint8)
    width = (7, 7, 21)[lost]
    cv2.line(only, *(tuple(int(x) for x in end) for end in lines[lost]), 1, width)
    found = reading_of(ink, [line for k, line in enumerate(lines) if k != lost])
    # Where bars cross, the other one reads the ink of both.
    assert found.ink_read == pytest.approx(1 - only.sum() / ink.sum(), abs=0.03)


def test_a_line_beside_the_ink_is_on_none():
    ink, lines = crossing()
    found = reading_of(ink, [*lines, np.array([[30.0, 90], [270, 90]])])
    across = 7 / 240  # where it crosses a bar
    assert found.lines_on_ink == pytest.approx((540 + 240 * across) / 780, abs=0.01)


def test_a_thin_line_through_thick_ink_reads_what_is_about_it():
    """What counts is the ink's width where the line is, not what the reader says."""
    ink, lines = crossing()
    rim = lines[2] + [0, 9]  # along the edge, where the ink is one pixel deep
    assert reading_of(ink, [*lines[:2], rim]).ink_read < 0.75


def test_blots_are_read_and_specks_are_not_counted():
    ink, lines = crossing()
    blots = np.zeros(ink.shape, bool)
    blots[100:112, 10:22] = True
    specked = ink | blots
    specked[190, 290:294] = True
    found = reading_of(specked, lines, blots)
    assert found.ink == (ink | blots).sum() and found.ink_read > 0.999


def test_drawings_of_pixels_know_how_they_were_read(tmp_path):
    ink, _ = crossing()
    picture = np.uint8(255 * ~ink)
    picture[100:103, 100:103] = 0  # left out as a speck, and yet ink
    Image.fromarray(picture).save(tmp_path / "a.png")
    reading = read_drawing(tmp_path / "a.png", RasterSettings(style="skeleton", speck=20)).reading
    assert reading is not None and 0.98 < reading.ink_read < 1 and reading.lines_on_ink > 0.99
    assert reading.ink == ink.sum() + 9
    assert read_drawing(tmp_path / "a.png", RasterSettings(style="area")).reading is None
