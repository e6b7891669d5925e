"""Curves to follow: long enough, wide enough, one stroke."""

import numpy as np
import pytest

from experiments.tracking import CURVES


@pytest.mark.parametrize("name", sorted(CURVES))
def test_each_is_one_long_even_stroke_about_the_middle(name):
    curve = CURVES[name]()
    steps = np.linalg.norm(np.diff(curve, axis=0), axis=1)
    assert steps.sum() >= (2.3 if name == "line" else 3.0)
    assert steps.max() < 0.01
    np.testing.assert_allclose((curve.max(0) + curve.min(0)) / 2, 0, atol=0.01)
    # Wider than an arm serves from one place.
    assert np.ptp(curve[:, 0]) >= 1.2 and np.ptp(curve[:, 1]) <= 0.6
