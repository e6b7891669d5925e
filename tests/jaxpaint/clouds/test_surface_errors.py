"""Statistics of distances and angles, by hand."""

import numpy as np
import pytest

from jaxpaint.clouds import normal_error, point_to_surface


def test_distances_by_hand():
    found = point_to_surface(np.asarray([1.0, -1.0, 2.0, 100.0]), np.asarray([True, True, True, False]))
    assert found.mean == pytest.approx(4 / 3)
    assert found.rms == pytest.approx(np.sqrt(2))
    assert found.p95 == pytest.approx(1.9)


def test_angles_whatever_the_sign_down_to_the_smallest():
    angle = np.asarray([0, 1e-7, 0.3, np.pi / 2])
    normals = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    truth = np.asarray([[1, 0, 0], [-1, 0, 0], [-1, 0, 0], [1, 0, 0]])
    found = normal_error(normals, truth, angle < 1)
    assert found.mean == pytest.approx((1e-7 + 0.3) / 3)
    assert normal_error(normals[1:2], truth[1:2]).p95 == pytest.approx(1e-7)
    assert normal_error(normals, truth).mean == pytest.approx((1e-7 + 0.3 + np.pi / 2) / 4)


def test_without_valid_points_there_is_no_figure():
    none = np.zeros(4, bool)
    assert point_to_surface(np.ones(4), none).mean == np.inf
    assert normal_error(np.ones((4, 3)), np.ones((4, 3)), none).p95 == np.inf
