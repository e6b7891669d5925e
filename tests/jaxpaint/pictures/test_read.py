"""What is drawn, where, and what is left out."""

import numpy as np
import pytest

from jaxpaint.pictures import read_drawing

SQUARE = "M10 10h20v20h-20z"


def test_v_is_up(draw):
    (line,) = draw('<path d="M10 20 L30 60"/>').lines
    assert line.tolist() == [[10, -20], [30, -60]]


@pytest.mark.realdata
def test_shapes_of_a_real_plotter_file(shared_data):
    drawing = read_drawing(shared_data / "images" / "all_shapes.svg")
    circle, box, rounded, ellipse, line, polygon, polyline = drawing.lines
    np.testing.assert_allclose(np.hypot(*(circle - [50, -200]).T), 40, rtol=1e-5)
    assert box.tolist() == [[10, -10], [110, -10], [110, -50], [10, -50], [10, -10]]
    np.testing.assert_allclose([rounded.min(axis=0), rounded.max(axis=0)], [[200, -50], [300, -10]])
    assert len(rounded) > len(box)
    np.testing.assert_allclose(np.hypot(*((ellipse - [200, -200]) / [50, 30]).T), 1, rtol=1e-5)
    assert line.tolist() == [[5, -300], [200, -320]]
    assert polygon[0].tolist() == polygon[-1].tolist() == [5, -340] and len(polygon) == 5
    assert len(polyline) == 4
    assert drawing.closed == (True, True, True, True, False, True, False)
    assert not drawing.areas and set(drawing.line_colours) == {0}


@pytest.mark.realdata
@pytest.mark.parametrize(
    ("name", "lines", "rings", "ignored"),
    [
        ("03042", 3, [], {"text": 3}),
        ("04e00", 1, [], {"text": 1}),
        ("06c38", 5, [], {"text": 5}),
        ("09f8d", 16, [], {"text": 16}),
        ("apple", 0, [1, 1], {}),
        ("arc_with_rotate", 6, [], {}),
        ("audi", 0, [8], {}),
        ("few_beziers", 12, [], {}),
        ("gnu", 0, [1, 1, 1, 1, 1, 1, 1, 6], {}),
        ("julia", 0, [1, 1, 1], {}),
        ("multilayer", 4, [], {}),
        ("opencv", 0, [1, 1, 1], {}),
        ("python", 0, [2, 2], {}),
        ("ros", 0, [1] * 9, {}),
        ("rust", 0, [10], {}),
    ],
)
def test_real_files(shared_data, name, lines, rings, ignored):
    drawing = read_drawing(shared_data / "images" / f"{name}.svg")
    assert (len(drawing.lines), sorted(len(area.rings) for area in drawing.areas)) == (lines, rings)
    assert (drawing.name, drawing.ignored) == (name, ignored)


@pytest.mark.realdata
def test_circles_of_a_real_logo(shared_data):
    """Julia's three discs, each a path of relative arcs: circles of radius 5.569 to the tolerance."""
    for area in read_drawing(shared_data / "images" / "julia.svg").areas:
        (line,) = area.rings
        middle = (line.min(axis=0) + line.max(axis=0)) / 2
        np.testing.assert_allclose(np.hypot(*(line - middle).T), 5.569, atol=2e-4 * 24)


def test_a_fill_is_an_area_closed_by_a_straight_line(draw):
    drawing = draw('<path d="M10 10h20v20" fill="red" stroke="none"/>')
    (area,) = drawing.areas
    assert {tuple(point) for point in area.rings[0].tolist()} == {(10, -10), (30, -10), (30, -30)}
    assert not drawing.lines and drawing.colours == ((1, 0, 0),)


def test_fill_and_stroke_of_one_shape_are_an_area_and_a_line(draw):
    drawing = draw(f'<path d="{SQUARE}" fill="red"/>')
    assert (len(drawing.lines), len(drawing.areas)) == (1, 1)
    assert drawing.colours == ((1, 0, 0), (0, 0, 0))
    assert (drawing.line_colours, drawing.areas[0].colour) == ((1,), 0)


@pytest.mark.parametrize(
    "shape", ['<line x2="9" y2="9"/>', '<path d="M0 0L9 9"/>', '<path d="M0 0L9 9L3 3"/>']
)
def test_what_encloses_no_area_is_a_stroke(draw, shape):
    drawing = draw(shape, head='stroke="black"')
    assert drawing.closed == (False,) and not drawing.areas


@pytest.mark.parametrize(
    "again",
    [
        f'<path d="{SQUARE}"/>',
        '<rect x="10" y="10" width="20" height="20"/>',
        '<path d="M30 30v-20h-20v20z"/>',
        '<g transform="translate(5 5) scale(2)"><path d="M2.5 2.5h10v10h-10z"/></g>',
    ],
)
def test_a_line_drawn_twice_counts_once(draw, again):
    drawing = draw(f'<path d="{SQUARE}"/>{again}<path d="M50 50L60 70"/><path d="M60 70L50 50"/>')
    assert len(drawing.lines) == 2
    assert drawing.ignored == {"duplicate": 2}


def test_what_is_left_out_is_counted(draw):
    body = (
        '<text>a</text><text>b</text><image width="3" height="3"/><path d="M0 0h0"/><use href="other.svg#a"/>'
    )
    drawing = draw(f'{body}<g clip-path="url(#c)" mask="url(#m)"><path d="{SQUARE}"/></g>')
    assert drawing.ignored == {"text": 2, "image": 1, "dot": 1, "use": 1, "clip-path": 1, "mask": 1}


def test_paper_under_the_picture_is_not_ink(draw):
    paper = '<rect width="100%" height="100%" fill="#FFFFFF" stroke="none"/>'
    for colour in ("#FFFFFF", "blue"):
        drawing = draw(f'{paper.replace("#FFFFFF", colour)}<path d="{SQUARE}"/>')
        assert (drawing.ignored, len(drawing.lines), drawing.areas) == ({"background": 1}, 1, ())
    assert len(draw(f'<path d="{SQUARE}"/>{paper.replace("#FFFFFF", "blue")}').areas) == 1


@pytest.mark.parametrize(
    "shape",
    [
        '<circle cx="50" cy="50" r="50" fill="{}" stroke="none"/>',
        '<path d="M0 100L50 0L100 100z" fill="{}" stroke="none"/>',
        '<path d="M0 0H100V100H0zM40 40h20v20h-20z" fill="{}" fill-rule="evenodd" stroke="none"/>',
    ],
)
def test_a_shape_that_only_reaches_the_sides_of_the_page_is_ink(draw, shape):
    alone = draw(shape.format("black"))
    assert (len(alone.areas), alone.colours, alone.ignored) == (1, ((0, 0, 0),), {})
    under = draw(
        shape.format("red") + '<rect x="45" y="70" width="9" height="9" fill="white" stroke="none"/>'
    )
    assert under.colours == ((1, 0, 0),) and len(under.areas[0].rings) > len(alone.areas[0].rings)


@pytest.mark.parametrize(
    "paper",
    [
        '<rect x="-9" y="-9" width="200" height="118"/>',
        '<rect width="100" height="100" rx="9"/>',
        '<rect x="2" y="2" width="4" height="4" transform="scale(25) translate(-2 -2)"/>',
    ],
)
def test_paper_may_be_larger_round_at_its_corners_or_moved(draw, paper):
    drawing = draw(f'<g fill="blue" stroke="none">{paper}</g><path d="{SQUARE}" stroke="white"/>')
    assert (drawing.ignored, drawing.areas, drawing.colours) == ({"background": 1}, (), ((1, 1, 1),))


def test_a_page_in_a_colour_with_nothing_on_it_is_the_picture(draw):
    page = '<rect width="100%" height="100%" fill="blue" stroke="none"/>'
    for more in ("", f'<path d="{SQUARE}" fill="blue" stroke="none"/>'):
        drawing = draw(page + more)
        assert (drawing.colours, len(drawing.areas), drawing.ignored) == (((0, 0, 1),), 1, {})


def test_black_on_a_page_with_a_gradient_is_ink(draw):
    page = '<rect width="100%" height="100%" fill="url(#g)" stroke="none"/>'
    drawing = draw(f'{page}<path d="{SQUARE}"/>')
    assert (len(drawing.lines), drawing.areas) == (1, ())
    assert drawing.ignored == {"background": 1, "gradient": 1}


def test_a_frame_drawn_round_the_page_is_ink(draw):
    framed = '<rect width="100%" height="100%" fill="white" stroke="black"/>'
    assert len(draw(f'{framed}<path d="{SQUARE}"/>').lines) == 2


def test_an_ending_at_the_start_closes_a_line(draw):
    drawing = draw('<path d="M10 10 a5 5 0 0 1 10 0 a5 5 0 0 1 -10 0.00000001"/>')
    assert drawing.closed == (True,)


def test_flattening_is_relative_to_the_drawing(draw):
    """The same picture in other units has the same points."""
    small = draw('<circle r="1" cx="3" cy="2"/>')
    large = draw('<circle r="1000" cx="3000" cy="2000"/>')
    np.testing.assert_allclose(large.lines[0], small.lines[0] * 1000, rtol=1e-9)


def test_utf_16_and_byte_order_marks(tmp_path):
    text = '<svg xmlns="http://www.w3.org/2000/svg"><path d="M0 0L9 9" stroke="black"/></svg>'
    for encoding in ("utf-16", "utf-8-sig"):
        path = tmp_path / "a.svg"
        path.write_bytes(text.encode(encoding))
        assert len(read_drawing(path).lines) == 1
