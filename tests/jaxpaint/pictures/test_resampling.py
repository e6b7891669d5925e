"""Even spacing along the line, with its ends and corners."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from jaxpaint.pictures.drawing import polyline_length
from jaxpaint.pictures.resampling import resample

polylines = (
    st.integers(2, 12)
    .flatmap(lambda n: arrays(float, (n, 2), elements=st.floats(-1, 1).map(lambda x: round(x, 4))))
    .filter(lambda line: polyline_length(line) > 0)
)


def turns(line: np.ndarray) -> np.ndarray:
    """By how much a polyline turns at each inner point [rad]."""
    steps = np.diff(line, axis=0)
    cosine = (
        (steps[:-1] * steps[1:]).sum(-1)
        / np.linalg.norm(steps[:-1], axis=1)
        / np.linalg.norm(steps[1:], axis=1)
    )
    return np.arccos(np.clip(cosine, -1, 1))


@given(polylines, st.sampled_from([0.01, 0.1, 5.0]))
def test_spacing_ends_and_corners(line, spacing):
    points = resample(line, spacing)
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    assert len(points) >= 2
    assert steps.max() <= spacing * (1 + 1e-6)
    assert points[0].tolist() == line[0].tolist() and points[-1].tolist() == line[-1].tolist()
    distinct = line[np.concatenate([[True], (np.diff(line, axis=0) != 0).any(axis=1)])]
    corners = distinct[1:-1][turns(distinct) > np.radians(21)]
    for corner in corners:
        assert np.linalg.norm(points - corner, axis=1).min() < 1e-9
    assert polyline_length(points) <= polyline_length(line) * (1 + 1e-9)


def test_no_more_points_than_the_spacing_asks_for():
    assert len(resample(np.array([[0.0, 0], [1, 0]]), 0.25)) == 5
    assert len(resample(np.array([[0.0, 0], [0.3, 0], [0.9, 0], [1, 0]]), 0.25)) == 5
    assert len(resample(np.array([[0.0, 0], [1, 0]]), 3.0)) == 2


@pytest.mark.parametrize(("degrees", "kept"), [(15, False), (25, True), (180, True)])
def test_a_corner_is_a_turn_above_twenty_degrees(degrees, kept):
    angle = np.radians(degrees)
    line = np.array([[-0.13, 0], [0, 0], [0.13 * np.cos(angle), 0.13 * np.sin(angle)]])
    points = resample(line, 0.02)
    assert (np.linalg.norm(points, axis=1).min() < 1e-12) == kept


def test_a_circle_is_sampled_evenly_along_its_arc():
    t = np.linspace(0, 2 * np.pi, 721)
    points = resample(np.stack([np.cos(t), np.sin(t)], axis=1), 0.1)
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    np.testing.assert_allclose(steps, 2 * np.pi / 63, rtol=1e-3)
    np.testing.assert_allclose(np.hypot(*points.T), 1, atol=1e-4)
