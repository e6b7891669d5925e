"""The bilateral filter: flat where it is flat, and kinder to edges than an average."""

from dataclasses import replace

import numpy as np
import pytest

from jaxpaint.clouds import Edge, edge_sharpness
from jaxpaint.refinement import BilateralSettings, bilateral_filter

EDGE = Edge(np.zeros(3), np.asarray([0, 1.0, 0]), np.asarray([1.0, 0, 0]), np.asarray([0, 0, 1.0]))


def test_a_noisy_plane_gets_four_times_flatter(flat):
    inner = (np.abs(flat[:, 0] - 0.5) < 0.3) & (np.abs(flat[:, 1] - 0.4) < 0.24)
    height = bilateral_filter(flat).points @ [0, 0.6, 0.8]
    assert height[inner].std() < 0.25 * (flat @ [0, 0.6, 0.8])[inner].std()


def test_an_edge_is_kept_better_than_by_averaging(folded):
    near = BilateralSettings(neighbours=64, sigma_d=2.5)
    kept = edge_sharpness(bilateral_filter(folded, near).points, EDGE, reach=0.12)
    # heights of any size count: a plain average along the normal
    average = bilateral_filter(folded, replace(near, sigma_n=1e3)).points
    cut = edge_sharpness(average, EDGE, reach=0.12)
    raw = edge_sharpness(folded, EDGE, reach=0.12)
    assert kept.rounding < 0.6 * cut.rounding
    assert kept.mean < 0.7 * raw.mean < 0.7 * cut.mean


def test_points_move_along_their_normals_alone(flat):
    found = bilateral_filter(flat, BilateralSettings(iterations=1))
    moved = found.points - flat
    across = moved - (moved * found.normals).sum(1, keepdims=True) * found.normals
    assert np.abs(across).max() < 1e-12


@pytest.mark.parametrize("name", ["neighbours", "sigma_d", "sigma_n", "iterations"])
def test_a_setting_of_nothing_is_refused(name: str):
    with pytest.raises(ValueError, match=name):
        BilateralSettings(**{name: 0})
