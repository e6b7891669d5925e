"""Later ink lies over earlier ink, and paper-coloured ink over both."""

import numpy as np
import pytest

from jaxpaint.errors import InputError
from jaxpaint.pictures import fit, plan_strokes, read_drawing
from jaxpaint.pictures.palette import MOST, merged
from jaxpaint.pictures.regions import region_of

FILLED = 'fill="red" stroke="none"'
RECT = '<rect x="{}" y="{}" width="{}" height="{}" fill="{}" stroke="none"/>'


def rect(x, y, w, h, fill):
    return RECT.format(x, y, w, h, fill)


def area_of(drawing, colour) -> float:
    return sum(region_of(area).area for area in drawing.areas if area.colour == colour)


def test_a_later_fill_covers_an_earlier_one(draw):
    drawing = draw(rect(0, 0, 40, 40, "yellow") + rect(20, 20, 40, 40, "navy"))
    assert drawing.colours == ((1, 1, 0), (0, 0, pytest.approx(128 / 255)))
    assert [area_of(drawing, k) for k in (0, 1)] == pytest.approx([1200, 1600])
    a, b = (region_of(area) for area in drawing.areas)
    assert a.intersection(b).area == pytest.approx(0, abs=1e-9)


def test_fills_of_one_colour_are_one_area_where_they_touch(draw):
    drawing = draw(rect(0, 0, 40, 40, "red") + rect(40, 0, 40, 40, "#fe0000") + rect(0, 60, 9, 9, "red"))
    assert len(drawing.areas) == 2 and len(drawing.colours) == 1


def test_paper_cuts_what_lies_below_and_is_no_ink(draw):
    drawing = draw(rect(0, 0, 40, 40, "red") + rect(10, 10, 20, 20, "#fffffe") + rect(80, 80, 5, 5, "white"))
    (area,) = drawing.areas
    assert len(area.rings) == 2 and region_of(area).area == pytest.approx(1200)
    black = rect(0, 0, 100, 100, "black")
    drawing = draw(black + rect(0, 0, 40, 40, "white") + rect(10, 10, 20, 20, "#000"))
    assert drawing.colours == ((1, 1, 1),) and area_of(drawing, 0) == pytest.approx(1200)


def test_a_paper_line_cuts_by_its_width(draw):
    line = '<path d="M0 20H40" stroke="white" stroke-width="4"/>'
    drawing = draw(rect(0, 0, 40, 40, "red") + line)
    assert len(drawing.areas) == 2 and area_of(drawing, 0) == pytest.approx(1440, rel=0.01)
    assert not drawing.lines


def test_a_fill_hides_the_line_below_it_but_not_the_one_above(draw):
    line = '<path d="M10 10H90"/>'
    square = rect(40, 0, 20, 20, "yellow")
    below, above = draw(line + square), draw(square + line)
    assert [np.ptp(part[:, 0]) for part in below.lines] == pytest.approx([30, 30], abs=0.01)
    assert [np.ptp(part[:, 0]) for part in above.lines] == pytest.approx([80])


def line(colour: str, width: float, data: str = "M10 20L60 50") -> str:
    return f'<path d="{data}" stroke="{colour}" stroke-width="{width}"/>'


@pytest.mark.parametrize(
    ("below", "above", "seen"),
    [
        (line("white", 6), line("black", 2), (0, 0, 0)),
        (line("red", 2), line("blue", 2), (0, 0, 1)),
        (line("red", 2), line("blue", 2, "M60 50L10 20"), (0, 0, 1)),
        (line("black", 6), line("white", 2), (0, 0, 0)),  # a road between its rims
    ],
)
def test_of_a_line_drawn_again_the_topmost_is_seen(draw, below, above, seen):
    drawing = draw(below + above)
    assert (len(drawing.lines), drawing.colours, drawing.ignored) == (1, (seen,), {"duplicate": 1})
    assert np.ptp(drawing.lines[0][:, 0]) == pytest.approx(50)


def test_a_line_under_the_same_one_of_paper_is_hidden(draw):
    with pytest.raises(InputError, match="nothing to draw"):
        draw(line("red", 2) + line("white", 2))


def test_a_line_drawn_again_over_what_hid_it_is_seen(draw):
    drawing = draw(line("red", 2) + rect(0, 0, 100, 90, "yellow") + line("red", 2))
    assert len(drawing.lines) == 1 and len(drawing.colours) == 2


def test_a_line_along_the_rim_of_what_covers_it_stays(draw):
    drawing = draw('<path d="M10 20H30"/>' + rect(10, 20, 20, 20, "yellow"))
    assert len(drawing.lines) == 1 and np.ptp(drawing.lines[0][:, 0]) == pytest.approx(20)


def test_what_is_covered_completely_is_not_there(draw):
    drawing = draw(rect(10, 10, 5, 5, "red") + rect(0, 0, 40, 40, "blue"))
    assert drawing.colours == ((0, 0, 1),) and len(drawing.areas) == 1


@pytest.mark.parametrize(
    "cover",
    [
        '<circle cx="49.7" cy="49.9" r="30" transform="translate(.3 .1)" {}/>',
        '<path d="M20 50A30 30 0 0 1 50 20A30 30 0 0 1 80 50A30 30 0 0 1 35 75.98A30 30 0 0 1 20 50" {}/>',
        '<circle cx="50.0003" cy="50" r="30" {}/>',
    ],
)
def test_what_is_covered_but_for_rounding_has_no_pass_of_its_own(draw, cover):
    drawing = draw('<circle cx="50" cy="50" r="30" fill="black" stroke="none"/>' + cover.format(FILLED))
    assert drawing.colours == ((1, 0, 0),) and len(drawing.areas) == 1


def test_what_covers_nearly_all_leaves_a_rim_and_a_hairline_stays(draw):
    crescent = (
        '<circle cx="50" cy="50" r="30" fill="black" stroke="none"/><circle cx="50" cy="50.1" r="30" {}/>'
    )
    assert len(draw(crescent.format(FILLED)).colours) == 2
    hairline = rect(0, 50, 100, 0.01, "black") + rect(20, 20, 40, 60, "red")
    assert [area.colour for area in draw(hairline).areas] == [0, 1, 1]


def test_all_of_the_papers_colour_is_nothing_to_draw(draw):
    with pytest.raises(InputError, match="nothing to draw"):
        draw(rect(0, 0, 40, 40, "white"))


@pytest.mark.parametrize(("rule", "area"), [("nonzero", 81), ("evenodd", 72)])
def test_fill_rules(draw, rule, area):
    path = f'<path d="M0 0h9v9h-9zM3 3h3v3h-3z" fill="black" stroke="none" fill-rule="{rule}"/>'
    assert area_of(draw(path), 0) == pytest.approx(area)


def test_colours_are_inherited_and_from_style_sheets(draw):
    body = (
        "<style>.a{fill:lime}</style>"
        '<g fill="red" color="blue"><rect width="9" height="9" stroke="none"/>'
        '<rect x="20" width="9" height="9" class="a" stroke="none"/>'
        '<rect x="40" width="9" height="9" style="fill:currentColor" stroke="none"/></g>'
    )
    assert set(draw(body).colours) == {(1, 0, 0), (0, 1, 0), (0, 0, 1)}


def test_gradients_are_noted(draw):
    drawing = draw(rect(0, 0, 9, 9, "url(#g)"))
    assert drawing.ignored == {"gradient": 1} and drawing.colours == ((0, 0, 0),)


def test_palettes_merge_what_is_near_and_keep_colours_of_the_picture():
    reds = [(1.0, 0.0, 0.0), (0.98, 0.02, 0.0), (0.0, 0.0, 1.0)]
    palette, place = merged(reds, [1, 5, 1])
    assert palette == ((0.98, 0.02, 0.0), (0.0, 0.0, 1.0)) and place.tolist() == [0, 0, 1]


def test_palettes_have_few_colours():
    many = [tuple(c) for c in np.random.default_rng(0).uniform(0, 1, (200, 3))]
    palette, place = merged(many, [1.0] * 200)
    assert len(palette) <= MOST and set(place) == set(range(len(palette))) and set(palette) <= set(many)


def test_colours_beyond_the_palette_are_counted(draw):
    hues = [f"hsl({360 * k / 11:.0f}, 100%, 50%)" for k in range(11)]
    drawing = draw("".join(rect(9 * k, 0, 8, 8, hue) for k, hue in enumerate(hues)))
    # Two of the greens look alike and count as one.
    assert (len(drawing.areas), len(drawing.colours), drawing.ignored) == (11, MOST, {"colour": 2})


@pytest.mark.realdata
def test_a_logo_in_two_colours(shared_data, svg_file):
    """Python's snakes: the lower one, from its third sub-path on, in a colour of its own."""
    text = (shared_data / "images" / "python.svg").read_text()
    data = text.partition(' d="')[2].partition('"')[0]
    upper, _, lower = data.partition("m13.09 3.95")
    body = f'<path d="{upper}" fill="#306998"/><path d="M21.04 6.11{lower}" fill="#ffd43b"/>'
    drawing = read_drawing(svg_file(body, head='viewBox="0 0 24 24"'))
    assert [len(area.rings) for area in drawing.areas] == [2, 2]
    np.testing.assert_allclose(np.array(drawing.colours) * 255, [[255, 212, 59], [48, 105, 152]], atol=0.5)
    yellow, blue = drawing.areas
    assert yellow.rings[0][:, 1].max() < blue.rings[0][:, 1].max()
    strokes = plan_strokes(fit(drawing, (0.6, 0.6)), 0.005)
    first = strokes.points[strokes.colour[strokes.stroke] == 0]
    assert first[:, 1].mean() < 0 < strokes.points[strokes.colour[strokes.stroke] == 1][:, 1].mean()
