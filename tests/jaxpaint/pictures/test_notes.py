"""What a person is told of a picture: what is not painted, what otherwise, and how well lines were read."""

import dataclasses

import numpy as np
import pytest

from jaxpaint.pictures import Drawing, Reading, plan_strokes, reading_notes

SQUARE = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1], [0, 0]])
TINY = np.array([[2.0, 0], [2.0004, 0]])


def notes(ignored=None, reading=None, lines=(SQUARE,)) -> list[str]:
    drawing = Drawing(lines, (0,) * len(lines), (), ((0.0, 0.0, 0.0),), "a", ignored or {}, reading)
    return reading_notes(drawing, plan_strokes(drawing, 0.1))


def test_nothing_to_say_is_no_line():
    assert notes() == []


def test_what_is_left_out_and_what_is_painted_otherwise():
    found = notes({"clip-path": 1, "text": 16, "dot": 1, "gradient": 2, "colour": 3, "new": 2})
    assert found == [
        "left out of the picture: 16 texts, 1 line without length, 2 new",
        "painted otherwise than in the picture: 1 clip path (painted unclipped), "
        "2 gradients or patterns (painted black), 3 colours too many (painted in the nearest)",
    ]


def test_lines_too_short_to_paint():
    assert notes(lines=(SQUARE, TINY)) == ["left out, shorter than 1 mm: 1 line"]


@pytest.mark.parametrize(("under", "said"), [(996, "99.6 %"), (1000, "100.0 %"), (9999, "99.9 %")])
def test_how_well_lines_were_read(under, said):
    reading = Reading(ink=1000 if under <= 1000 else 10_000, under=under, length=50.0, on_ink=45.0)
    assert notes(reading=reading) == [
        f"of the ink, {said} lies under the lines that were read; of the lines, 90.0 % on ink"
    ]


def test_everything_that_readers_count_has_words(draw):
    body = (
        '<rect width="100%" height="100%" fill="#eee" stroke="none"/><text>a</text>'
        '<image width="3" height="3"/><foreignObject/><use href="b.svg#a"/><path d="M0 0h0"/>'
        '<g clip-path="url(#c)" mask="url(#m)"/>'
        '<path d="M1 1L9 9"/><path d="M9 9L1 1"/><rect width="9" height="9" fill="url(#g)"/>'
    )
    drawing = draw(body)
    assert len(drawing.ignored) == 10
    both = dataclasses.replace(drawing, ignored={**drawing.ignored, "cmyk": 1, "colour": 1})
    said = " ".join(reading_notes(both, plan_strokes(both, 1.0)))
    assert not any(f"1 {name}," in f"{said}," for name in ("clip-path", "foreignObject", "use", "cmyk"))
    assert said.count("1 ") == 12
