"""The camera sees all it is to show, and is no further away than it must be."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from experiments.viewing.camera import FIELD, view_of


def seen(points, view, aspect):
    """Places in the picture, from -1 to 1."""
    right = np.cross(view.forward, [0, 0, 1])
    right /= np.linalg.norm(right)
    away = points - view.position
    ahead = away @ view.forward
    aside = np.stack([away @ right, away @ np.cross(right, view.forward)], axis=1)
    assert (ahead > 0).all()
    return aside / ahead[:, None] / np.tan(FIELD / 2) / [aspect, 1]


@given(st.integers(0, 1000), st.floats(-3.1, 3.1), st.sampled_from([0.5, 4 / 3, 3.0]))
def test_all_points_are_in_the_picture_and_fill_it(seed, yaw, aspect):
    random = np.random.default_rng(seed)
    points = random.uniform(-1, 1, (30, 3)) * random.uniform(0.2, 2, 3) + random.uniform(-3, 3, 3)
    places = seen(points, view_of(points, yaw, aspect), aspect)
    assert np.abs(places).max() == pytest.approx(1 / 1.05, abs=1e-3)
    assert np.abs(places.max(axis=0) + places.min(axis=0)).max() < 0.05, "in the middle"


def test_it_stands_behind_and_above_and_looks_at_the_wall():
    points = np.array([[0, 1.2, 1.4], [0, -1.2, 0.8], [-1, 0, 0], [-1, 0, 1.7]])
    view = view_of(points, 0.0, 4 / 3)
    assert view.position[0] < -2
    assert view.position[2] > 1.7
    assert view.forward[0] > 0.7
