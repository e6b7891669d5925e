"""Strokes: what is painted, in which order, and what the pen travels between."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jaxpaint.errors import InputError
from jaxpaint.pictures import Drawing, Strokes, fit, plan_strokes, read_drawing
from jaxpaint.pictures.drawing import Polyline
from jaxpaint.pictures.routes import file_route, greedy_route, painted, shortened, travel

seeds = st.integers(0, 10_000)


def drawing_of(*lines) -> Drawing:
    points = tuple(np.array(line, dtype=float) for line in lines)
    return Drawing(points, (0,) * len(lines), (), ((0.0, 0.0, 0.0),), "test")


def random_drawing(seed: int, count: int) -> Drawing:
    """Open lines and closed ones (octagons), strewn over a square metre."""
    rng = np.random.default_rng(seed)
    octagon = 0.05 * np.exp(1j * np.linspace(0, 2 * np.pi, 9)).view(float).reshape(-1, 2)
    octagon[-1] = octagon[0]
    lines = [
        centre + (octagon if rng.random() < 0.4 else rng.normal(0, 0.05, (3, 2)))
        for centre in rng.uniform(0, 1, (count, 2))
    ]
    return drawing_of(*lines)


def stroke_list(strokes: Strokes) -> list[Polyline]:
    return strokes.lines


@given(seeds, st.integers(1, 25))
def test_travel_is_never_longer_than_in_the_order_of_the_file(seed, count):
    drawing = random_drawing(seed, count)
    short, as_drawn = plan_strokes(drawing, 0.1, order="shortest"), plan_strokes(drawing, 0.1, order="file")
    assert short.travel <= as_drawn.travel + 1e-12
    assert as_drawn.travel == pytest.approx(travel(list(drawing.lines)))
    assert short.length == pytest.approx(as_drawn.length)
    assert short.travel == pytest.approx(travel(stroke_list(short)))


@given(seeds, st.integers(2, 25))
def test_local_search_is_no_worse_than_greedy(seed, count):
    lines = list(random_drawing(seed, count).lines)
    greedy = greedy_route(lines, np.array([0.0, 1.0]))
    better = shortened(lines, greedy)
    assert travel(painted(lines, better)) <= travel(painted(lines, greedy)) + 1e-12
    assert better.order[0] == greedy.order[0] and better.entry[0] == greedy.entry[0]


def test_local_search_helps():
    """Over 20 pictures greedy wastes something that local search finds."""
    pictures = [list(random_drawing(seed, 25).lines) for seed in range(20)]
    greedy = [greedy_route(lines, np.array([0.0, 1.0])) for lines in pictures]
    before = sum(travel(painted(lines, route)) for lines, route in zip(pictures, greedy, strict=True))
    after = sum(
        travel(painted(lines, shortened(lines, route))) for lines, route in zip(pictures, greedy, strict=True)
    )
    assert after < 0.95 * before


@given(seeds, st.integers(1, 20))
def test_every_line_is_painted_once_and_whole(seed, count):
    drawing = random_drawing(seed, count)
    lines = list(drawing.lines)
    route = shortened(lines, greedy_route(lines, np.zeros(2)))
    assert sorted(route.order) == list(range(count))
    for i, line in zip(route.order, painted(lines, route), strict=True):
        ring = drawing.closed[i]
        assert sorted(line[:-1].tolist() if ring else line.tolist()) == sorted(
            lines[i][:-1].tolist() if ring else lines[i].tolist()
        )
        assert not ring or line[0].tolist() == line[-1].tolist()
    assert file_route(lines).order.tolist() == list(range(count))


@given(seeds, st.floats(0.005, 0.5))
def test_points_are_strokes_in_order_at_no_more_than_the_spacing(seed, spacing):
    strokes = plan_strokes(random_drawing(seed, 6), spacing)
    assert strokes.stroke.dtype == np.int32 and strokes.points.dtype == np.float64
    assert set(np.diff(strokes.stroke)) <= {0, 1} and strokes.stroke[0] == 0
    assert np.bincount(strokes.stroke).min() >= 2
    steps = np.linalg.norm(np.diff(strokes.points, axis=0), axis=1)[np.diff(strokes.stroke) == 0]
    assert steps.max() <= spacing * (1 + 1e-6) and steps.min() > 0


def test_a_person_begins_at_the_top_left():
    left, right = [[-1, 0.5], [-0.5, 0.5]], [[0.5, -0.5], [1, -0.5]]
    strokes = plan_strokes(drawing_of(right[::-1], left[::-1]), 0.1)
    assert strokes.points[0].tolist() == [-1, 0.5]
    assert strokes.points[-1].tolist() == [1, -0.5]
    assert plan_strokes(drawing_of(right, left), 0.1, start=(1, -0.5)).points[0].tolist() == [1, -0.5]


def test_a_start_in_the_middle_does_not_make_the_route_longer_than_the_file():
    row = [[[x, 0], [x + 0.9, 0]] for x in range(5)]
    assert plan_strokes(drawing_of(*row), 0.1, start=(2.0, 0.0)).travel == pytest.approx(0.4)


def test_an_outline_is_entered_where_the_pen_comes_from_and_closed_again():
    square = [[2, 0], [3, 0], [3, 1], [2, 1], [2, 0]]
    strokes = plan_strokes(drawing_of([[0, 1], [1.5, 1]], square), 0.1)
    outline = stroke_list(strokes)[1]
    assert outline[0].tolist() == outline[-1].tolist() == [2, 1]
    assert strokes.travel == pytest.approx(0.5)


def test_an_outline_is_entered_between_the_line_before_and_the_line_after():
    """Greedy enters the ring where it is nearest; the least detour towards the next line is elsewhere."""
    t = np.linspace(0, 2 * np.pi, 361)
    ring = np.stack([np.cos(t), np.sin(t)], axis=1)
    ring[-1] = ring[0]
    lines = [np.array([[-3.0, 0], [-2, 0]]), ring, np.array([[0.0, 2], [0, 3]])]
    middle = painted(lines, shortened(lines, greedy_route(lines, np.array([-3.0, 0]))))[1]
    np.testing.assert_allclose(middle[0], [-np.sqrt(0.5), np.sqrt(0.5)], atol=0.02)


def test_pieces_are_joined_and_dots_dropped():
    drawing = drawing_of([[0, 0], [1, 0]], [[2, 0], [1, 0]], [[0.5, 0.5], [0.5003, 0.5]])
    strokes = plan_strokes(drawing, 0.5)
    assert (strokes.count, strokes.dropped, strokes.length, strokes.travel) == (1, 1, pytest.approx(2), 0)


def test_short_pieces_of_a_long_line_are_no_dots():
    points = np.linspace(0, 1, 2001)
    pieces = [[[a, 0], [b, 0]] for a, b in pairwise(points)]
    strokes = plan_strokes(drawing_of(*pieces), 0.1)
    assert (strokes.count, strokes.dropped, strokes.length) == (1, 0, pytest.approx(1))


def test_the_same_drawing_gives_the_same_strokes():
    first, again = (plan_strokes(random_drawing(3, 40), 0.01) for _ in range(2))
    np.testing.assert_array_equal(first.points, again.points)


@pytest.mark.realdata
def test_handwriting_in_the_order_of_the_file(shared_data):
    """KanjiVG has its strokes as they are written: the first of this character is a dot at the top."""
    drawing = read_drawing(shared_data / "images" / "06c38.svg")
    strokes = plan_strokes(fit(drawing, (0.6, 0.6)), 0.005, order="file")
    starts = np.array([stroke[0] for stroke in stroke_list(strokes)])
    written = np.array([line[0] for line in fit(drawing, (0.6, 0.6)).lines])
    np.testing.assert_array_equal(starts, written)
    assert starts[0, 1] == starts[:, 1].max()
    assert plan_strokes(fit(drawing, (0.6, 0.6)), 0.005).travel < strokes.travel


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"spacing": 0.0}, "spacing: found 0.0"),
        ({"spacing": float("nan")}, "spacing: found nan"),
        ({"spacing": 0.1, "order": "random"}, "order: found 'random'; allowed are writing, shortest, file"),
    ],
)
def test_impossible_options(options, message):
    with pytest.raises(InputError, match=message):
        plan_strokes(drawing_of([[0, 0], [1, 1]]), **options)


def test_a_drawing_of_dots_only():
    with pytest.raises(InputError, match="test: found no line longer than 1 mm"):
        plan_strokes(drawing_of([[0, 0], [1e-4, 0]], [[1, 1], [1, 1.0001]]), 0.01)
