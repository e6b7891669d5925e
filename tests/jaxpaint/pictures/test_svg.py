"""Where SVG puts things: transforms, view boxes, copies, and whose style counts."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jaxpaint.pictures.markup import Element
from jaxpaint.pictures.svg import SvgReader

PATH = "M1 2 L5 3 C6 9 8 -1 9 4 A3 2 30 1 0 2 2"
numbers = st.floats(-3, 3).map(lambda x: round(x, 3))
scales = st.floats(0.2, 3).map(lambda x: round(x, 3))

# Each transform of SVG as text, with the matrix that the standard defines.
transforms = st.one_of(
    st.tuples(numbers, numbers).map(lambda a: (f"translate({a[0]},{a[1]})", _matrix(1, 0, 0, 1, *a))),
    st.tuples(scales, scales).map(lambda a: (f"scale({a[0]} {a[1]})", _matrix(a[0], 0, 0, a[1], 0, 0))),
    st.tuples(numbers).map(lambda a: (f"skewX({a[0] * 10})", _matrix(1, 0, _tan(a[0] * 10), 1, 0, 0))),
    st.tuples(numbers).map(lambda a: (f"skewY({a[0] * 10})", _matrix(1, _tan(a[0] * 10), 0, 1, 0, 0))),
    st.tuples(numbers).map(lambda a: (f"rotate({a[0] * 50})", _rotation(a[0] * 50))),
    st.tuples(numbers, numbers, numbers).map(
        lambda a: (
            f"rotate({a[0] * 50}, {a[1]}, {a[2]})",
            _matrix(1, 0, 0, 1, a[1], a[2]) @ _rotation(a[0] * 50) @ _matrix(1, 0, 0, 1, -a[1], -a[2]),
        )
    ),
    st.tuples(*[scales] * 2, *[numbers] * 2).map(
        lambda a: (f"matrix({a[0]} 0.1 0.2 {a[1]} {a[2]} {a[3]})", _matrix(a[0], 0.1, 0.2, *a[1:]))
    ),
)


def _matrix(a, b, c, d, e, f):
    return np.array([[a, c, e], [b, d, f], [0, 0, 1]])


def _rotation(degrees):
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return _matrix(c, s, -s, c, 0, 0)


def _tan(degrees):
    return np.tan(np.radians(degrees))


def controls(*children: Element, **attributes: str) -> np.ndarray:
    """The control points of all ink of an <svg> with these children."""
    ink = SvgReader(Element("svg", {"stroke": "black", "fill": "none", **attributes}, list(children))).ink
    return np.concatenate([curve.controls.reshape(-1, 2) for piece in ink for curve in piece.curves])


def path(data: str = PATH, **attributes: str) -> Element:
    return Element("path", {"d": data, **attributes})


@given(st.lists(st.lists(transforms, min_size=1, max_size=3), min_size=1, max_size=3))
def test_nested_transforms_multiply_from_the_outside_in(nested):
    element, expected = path(), np.eye(3)
    for listed in nested:
        element = Element("g", {"transform": " ".join(text for text, _ in listed)}, [element])
    for listed in reversed(nested):
        for _, matrix in listed:
            expected = expected @ matrix
    before = controls(path())
    after = before @ expected[:2, :2].T + expected[:2, 2]
    np.testing.assert_allclose(controls(element), after, rtol=1e-6, atol=1e-5)


@pytest.mark.parametrize(
    ("attributes", "corners"),
    [
        ({"viewBox": "0 0 10 10", "width": "20", "height": "20"}, [[0, 0], [20, 20]]),
        ({"viewBox": "-5 -5 10 10", "width": "20", "height": "20"}, [[10, 10], [30, 30]]),
        ({"viewBox": "0 0 10 10", "width": "40", "height": "20"}, [[10, 0], [30, 20]]),
        (
            {"viewBox": "0 0 10 10", "width": "40", "height": "20", "preserveAspectRatio": "none"},
            [[0, 0], [40, 20]],
        ),
        (
            {"viewBox": "0 0 10 10", "width": "40", "height": "20", "preserveAspectRatio": "xMaxYMid"},
            [[20, 0], [40, 20]],
        ),
        (
            {"viewBox": "0 0 10 10", "width": "40", "height": "20", "preserveAspectRatio": "xMidYMin slice"},
            [[0, 0], [40, 40]],
        ),
        ({"viewBox": "0,0,10,10"}, [[0, 0], [10, 10]]),
        ({"width": "1in", "height": "10mm"}, [[0, 0], [10, 10]]),
        ({"viewBox": "0 0 96 96", "width": "25.4mm", "height": "1in"}, [[0, 0], [10, 10]]),
    ],
)
def test_view_boxes(attributes, corners):
    found = controls(path("M0 0L10 10"), **attributes)
    np.testing.assert_allclose(found[[0, -1]], corners, atol=1e-9)


def test_nested_pages_have_their_own_view_box_and_percentages():
    line = Element("line", {"x1": "0", "y1": "0", "x2": "100%", "y2": "50%"})
    inner = Element(
        "svg", {"x": "10", "y": "20", "width": "40", "height": "40", "viewBox": "0 0 8 8"}, [line]
    )
    np.testing.assert_allclose(controls(inner, viewBox="0 0 100 100")[[0, -1]], [[10, 20], [50, 40]])


def test_use_draws_a_copy_where_it_says():
    shape = Element("defs", {}, [path("M0 0L1 1", id="a")])
    use = Element("use", {"href": "#a", "x": "3", "y": "4", "transform": "scale(2)"})
    np.testing.assert_allclose(controls(shape, use)[[0, -1]], [[6, 8], [8, 10]])


def test_use_hands_down_its_style():
    shape = Element("defs", {}, [path("M0 0L1 1", id="a"), path("M0 0L2 2", id="b", stroke="red")])
    uses = [Element("use", {"href": f"#{name}", "stroke": "none"}) for name in "ab"]
    assert controls(shape, *uses).max() == 2
    assert len(controls(shape, *uses)) == 4


def test_a_symbol_shows_only_in_use_and_in_the_size_of_the_use():
    symbol = Element("symbol", {"id": "s", "viewBox": "0 0 10 10"}, [path("M0 0L10 10")])
    use = Element("use", {"href": "#s", "x": "1", "width": "20", "height": "20"})
    np.testing.assert_allclose(controls(symbol, use)[[0, -1]], [[1, 0], [21, 20]])


@pytest.mark.parametrize(
    ("data", "ends"),
    [
        ("M1 1 2 2 3 1", [[1, 1], [2, 2], [2, 2], [3, 1]]),
        ("m1 1h2v2H0V0", [[1, 1], [3, 1], [3, 1], [3, 3], [3, 3], [0, 3], [0, 3], [0, 0]]),
        ("M0 0L1 0L1 1zl2 2", [[0, 0], [1, 0], [1, 0], [1, 1], [1, 1], [0, 0], [0, 0], [2, 2]]),
        ("M1.5.5-1-1", [[1.5, 0.5], [-1, -1]]),
        ("M10. 2L1e1,.5", [[10, 2], [10, 0.5]]),
        ("M0 0A0 1 0 0 0 4 4", [[0, 0], [4, 4]]),
    ],
)
def test_path_data(data, ends):
    np.testing.assert_allclose(controls(path(data)).reshape(-1, 4, 2)[:, [0, 3]].reshape(-1, 2), ends)


@pytest.mark.parametrize(
    ("smooth", "plain"),
    [
        ("M0 0C1 1 2 1 3 0S5 1 6 0", "M0 0C1 1 2 1 3 0C4 -1 5 1 6 0"),
        ("M0 0Q1 1 2 0T4 0", "M0 0Q1 1 2 0Q3 -1 4 0"),
        ("M0 0Q1 1 2 0S3 1 4 0", "M0 0Q1 1 2 0C2 0 3 1 4 0"),
        ("M0 0C1 1 2 1 3 0T4 1", "M0 0C1 1 2 1 3 0Q3 0 4 1"),
        ("M0 0L2 0S3 1 4 0", "M0 0L2 0C2 0 3 1 4 0"),
        ("M0 0q1 1 2 0s1 1 2 0", "M0 0Q1 1 2 0C2 0 3 1 4 0"),
    ],
)
def test_smooth_segments_continue_only_their_own_kind(smooth, plain):
    np.testing.assert_allclose(controls(path(smooth)), controls(path(plain)), atol=1e-12)


@given(st.floats(0.5, 3), st.floats(0.5, 3), st.floats(-90, 90), st.booleans(), st.booleans())
def test_arcs_lie_on_their_ellipse(rx, ry, turn, large, sweep):
    """All points agree with one ellipse of these radii, and the flags choose among the four arcs."""
    start, end = np.array([0.0, 0.0]), np.array([0.6, 0.3])
    curve = path(f"M0 0A{rx} {ry} {turn} {int(large)} {int(sweep)} {end[0]} {end[1]}")
    points = (
        SvgReader(Element("svg", {"stroke": "black", "fill": "none"}, [curve]))
        .ink[0]
        .curves[0]
        .flattened(1e-5)
    )
    np.testing.assert_allclose(points[[0, -1]], [start, end], atol=1e-9)
    unturned = points @ _rotation(turn)[:2, :2] / [rx, ry]
    # |p|^2 - 2 p.c + |c|^2 = 1 is linear in the centre c and in its last term.
    system = np.column_stack([2 * unturned, -np.ones(len(points))])
    solution, *_ = np.linalg.lstsq(system, (unturned**2).sum(axis=1), rcond=None)
    centre = solution[:2]
    np.testing.assert_allclose(np.hypot(*(unturned - centre).T), 1, atol=1e-4)
    d = unturned - centre
    turns = np.unwrap(np.arctan2(d[:, 1], d[:, 0]))
    assert (abs(turns[-1] - turns[0]) > np.pi) == large
    assert (turns[-1] > turns[0]) == sweep


@pytest.mark.parametrize("name", ["polyline", "polygon"])
def test_points(name):
    found = controls(Element(name, {"points": " 0,0 4-1 4e0,.5 "})).reshape(-1, 4, 2)
    assert found[:, 0].tolist() == [[0, 0], [4, -1], [4, 0.5]][: len(found)]
    assert len(found) == (3 if name == "polygon" else 2)


def test_prefixed_elements_and_links(draw):
    drawing = draw(
        '<s:g xmlns:s="http://www.w3.org/2000/svg">'
        '<s:path id="a" d="M0 0L9 9"/><s:use xlink:href="#a" x="5"/></s:g>'
    )
    assert [line[0].tolist() for line in drawing.lines] == [[0, 0], [5, 0]]
