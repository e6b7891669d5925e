"""Flattened curves stay within the tolerance, and no chord is wasted on straight lines."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from jaxpaint.pictures.curves import Curve, chain, straight

controls = arrays(float, (2, 4, 2), elements=st.floats(-10, 10).map(lambda x: round(x, 3)))


def on_curve(control: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Points of one cubic by repeated interpolation, which shares nothing with the code under test."""
    points = np.broadcast_to(control, (len(t), 4, 2))
    while points.shape[1] > 1:
        points = points[:, :-1] + t[:, None, None] * np.diff(points, axis=1)
    return points[:, 0]


def distance_to_line(points: np.ndarray, line: np.ndarray) -> np.ndarray:
    """How far each point is from a polyline."""
    start, step = line[:-1], np.diff(line, axis=0)
    along = ((points[:, None] - start) * step).sum(-1) / np.maximum((step**2).sum(-1), 1e-300)
    nearest = start + np.clip(along, 0, 1)[..., None] * step
    return np.linalg.norm(points[:, None] - nearest, axis=-1).min(axis=1)


@given(controls, st.sampled_from([1e-3, 1e-2, 0.3]))
def test_flattening_keeps_the_tolerance_and_the_joints(control, tolerance):
    curve = Curve(control, closed=False)
    line = curve.flattened(tolerance)
    dense = np.concatenate([on_curve(segment, np.linspace(0, 1, 200)) for segment in control])
    joint = curve.pieces(tolerance)[0]
    assert distance_to_line(dense[:200], line[: joint + 1]).max() <= tolerance + 1e-9
    np.testing.assert_allclose(
        line[[0, joint, -1]], [control[0, 0], control[0, 3], control[1, 3]], atol=1e-12
    )
    assert len(line) == curve.pieces(tolerance).sum() + 1


def test_straight_lines_need_one_piece():
    square = chain(np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]]), closed=True)
    assert square.flattened(1e-9).tolist() == [[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]]


def test_closing_adds_the_missing_side_once():
    corner = chain(np.array([[0.0, 0], [1, 0], [1, 1]]), closed=False)
    assert corner.closing().flattened(0.1).tolist() == [[0, 0], [1, 0], [1, 1], [0, 0]]
    assert len(corner.closing().closing().controls) == 3


@pytest.mark.parametrize(("third", "encloses"), [([2.0, 2.0], False), ([2.0, 2.1], True)])
def test_three_points_on_a_line_enclose_nothing(third, encloses):
    assert chain(np.array([[0.0, 0], [1, 1], third]), closed=True).encloses_area(1e-6) == encloses


@given(controls)
def test_affine_maps_act_on_the_curve_as_on_its_points(control):
    matrix = np.array([[0.5, -1.2, 3], [0.3, 2, -1], [0, 0, 1]])
    t = np.linspace(0, 1, 7)
    moved = Curve(control, closed=False).moved(matrix).controls[0]
    np.testing.assert_allclose(
        on_curve(moved, t), on_curve(control[0], t) @ matrix[:2, :2].T + matrix[:2, 2], atol=1e-9
    )


def test_straight_is_evenly_spaced():
    np.testing.assert_allclose(straight(np.zeros(2), np.array([3.0, 6.0])), [[0, 0], [1, 2], [2, 4], [3, 6]])
