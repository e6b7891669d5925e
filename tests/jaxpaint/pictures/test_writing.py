"""Column by column: what is cut, what stays whole, and what that saves a base."""

from itertools import pairwise

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from jaxpaint.pictures import Area, Drawing, FillSettings, plan_strokes
from jaxpaint.pictures.drawing import polyline_length
from jaxpaint.pictures.regions import areas_of
from jaxpaint.pictures.writing import Columns, base_travel, columns, cut, in_columns

COLOURS = ((1.0, 1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 0.0))


def lines_of(seed: int, count: int) -> list[np.ndarray]:
    rng = np.random.default_rng(seed)
    return list(rng.uniform(0, 2, (count, 1, 2)) + rng.normal(0, 0.2, (count, 6, 2)))


@given(st.integers(0, 10_000), st.integers(1, 12), st.integers(1, 12), st.floats(0.1, 1.0))
def test_the_order_is_a_permutation(seed, whole, parts, width):
    lines, pieces = lines_of(seed, whole), lines_of(seed + 1, parts)
    ordered = in_columns(lines, pieces, columns(lines + pieces, width))
    keys = [sorted((tuple(line[0]), tuple(line[-1]))) for line in ordered]
    assert sorted(keys) == sorted(sorted((tuple(line[0]), tuple(line[-1]))) for line in lines + pieces)


@given(st.integers(0, 10_000), st.floats(0.2, 1.0))
def test_a_cut_line_is_all_there_in_its_order(seed, width):
    (line,) = lines_of(seed, 1)
    parts = cut(line, columns([line], width))
    assert sum(polyline_length(part) for part in parts) == pytest.approx(polyline_length(line))
    assert all((a[-1] == b[0]).all() for a, b in pairwise(parts))
    assert all(polyline_length(part) >= 0.1 for part in parts) or len(parts) == 1


def test_a_ring_is_cut_where_columns_meet():
    t = np.linspace(0, 2 * np.pi, 400)
    ring = np.stack([np.cos(t), np.sin(t)], axis=1)
    ring[-1] = ring[0]
    parts = cut(ring, Columns(-1.0, 1.0, 2))
    assert sorted(np.sign(part[:, 0].mean()) for part in parts) == [-1, 1]
    assert sum(polyline_length(part) for part in parts) == pytest.approx(polyline_length(ring))


def test_columns_follow_from_left_to_right_and_begin_on_top():
    dashes = [np.array([[u, v], [u + 0.05, v]]) for u in (0.1, 0.5, 0.9) for v in (0.0, 0.5, 1.0)]
    rng = np.random.default_rng(0)
    shuffled = [dashes[k] for k in rng.permutation(9)]
    ordered = in_columns(shuffled, [], columns(dashes, 0.3))
    starts = np.array([line[0] for line in ordered]).reshape(3, 3, 2)
    assert (np.diff(starts[..., 0].min(axis=1)) > 0).all()
    assert (starts[:, 0, 1] == 1.0).all() and (starts[:, -1, 1] == 0.0).all()


def test_base_travel_is_what_an_arm_cannot_reach():
    there_and_back = [np.array([[0.0, 0], [1.0, 0], [0.2, 0]])]
    assert base_travel(there_and_back, reach=0.25) == pytest.approx(0.75 + 0.3)
    assert base_travel([np.array([[0.0, 0], [0.2, 0]])] * 5, reach=0.25) == 0


def test_filling_a_wide_area_drives_the_base_once():
    wide = Drawing((), (), tuple(areas_of(shapely.box(0, 0, 2, 0.5), 0)), COLOURS[:1], "test")
    for angle in (0.0, np.pi / 2):
        strokes = plan_strokes(wide, 0.01, fill=FillSettings(angle=angle))
        assert base_travel(strokes.lines) < 2.2
    around = plan_strokes(wide, 0.01, fill=FillSettings(angle=np.pi / 2), order="shortest")
    assert base_travel(around.lines) > 2.8


@given(st.integers(0, 10_000), st.sampled_from(["writing", "shortest", "file"]))
def test_colours_are_passes(seed, order):
    rng = np.random.default_rng(seed)
    boxes = [shapely.box(u, v, u + 0.05, v + 0.05) for u, v in np.arange(6).reshape(3, 2) * 0.2]
    areas = tuple(
        Area((np.array(part.exterior.coords),), int(k))
        for part, k in zip(boxes, rng.permutation(3), strict=True)
    )
    lines = tuple(lines_of(seed, 4))
    drawing = Drawing(lines, tuple(rng.integers(0, 3, 4).tolist()), areas, COLOURS, "test")
    strokes = plan_strokes(drawing, 0.01, order=order)
    assert strokes.colour.shape == (strokes.count,) and strokes.colour.dtype == np.int32
    assert (np.diff(strokes.colour) >= 0).all() and set(strokes.colour) == {0, 1, 2}
    assert len(strokes.lines) == strokes.count == strokes.stroke[-1] + 1
