"""Spacing and noise: right on planes, not misled by edges, right where both vary."""

import numpy as np
import pytest

from jaxpaint.refinement import noise, spacing


def test_spacing_of_a_grid_is_its_step():
    grid = np.stack(np.meshgrid(*[np.arange(40) * 0.02] * 2, [0.0]), -1).reshape(-1, 3)
    inner = (np.abs(grid[:, :2] - 0.39) < 0.28).all(1)
    np.testing.assert_allclose(spacing(grid)[inner], 0.02, rtol=0.03)


def test_noise_of_a_plane_is_its_standard_deviation(flat):
    assert np.median(noise(flat)) == pytest.approx(0.01, rel=0.12)
    assert noise(flat).min() > 0.007 and noise(flat).max() < 0.013


def test_an_edge_is_not_noise(folded):
    assert np.percentile(noise(folded), 99) < 2 * 0.004
    near = np.abs(folded).max(axis=1) < 0.05
    assert np.median(noise(folded)[near]) < 2 * 0.004


def test_noise_that_grows_is_followed():
    rng = np.random.default_rng(0)
    x, y = rng.uniform(1, 3, 3_000), rng.uniform(0, 1, 3_000)
    cloud = np.stack([x, y, rng.normal(0, 0.004 * x * x)], axis=1)
    inner = (x > 1.2) & (x < 2.8)
    ratio = noise(cloud)[inner] / (0.004 * x[inner] ** 2)
    assert 0.8 < np.median(ratio) < 1.05
    assert np.ptp(np.percentile(ratio, [5, 95])) < 0.5


def test_scales_keep_the_type_and_scale_with_the_cloud(flat, dtype):
    for scale in (spacing, noise):
        found = scale(flat.astype(dtype))
        assert found.dtype == dtype and found.shape == (2_000,)
        np.testing.assert_allclose(scale((8 * flat).astype(dtype)), 8 * found, rtol=1e-3)


def test_what_has_no_planes_gives_no_nan(awkward, dtype):
    for scale in (spacing, noise):
        found = scale(awkward.astype(dtype))
        assert np.isfinite(found).all() and (found >= 0).all()
