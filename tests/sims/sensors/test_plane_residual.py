"""Planes, outliers and holes in made-up depth images."""

import numpy as np
import pytest

from sims.sensors.plane_residual import LAGS, blocks, plane_residual, variogram


def slanted(height=60, width=80):
    v, u = np.indices((height, width))
    return 40 / (20 + 0.05 * u - 0.02 * v)


def test_a_plane_leaves_nothing_however_slanted():
    found = plane_residual(slanted(), 40.0)
    np.testing.assert_allclose(found.residual, 0, atol=1e-9)
    np.testing.assert_allclose(found.slope, [0.05, -0.02], rtol=1e-9)
    assert found.outliers == 0


def test_holes_and_another_surface_are_left_out():
    depth = slanted()
    depth[10:20, 10:20], depth[30, :40], depth[31, :40] = 0.5, np.nan, 0
    found = plane_residual(depth, 40.0)
    missing = np.isnan(found.residual)
    assert missing[10:20, 10:20].all() and missing[30:32, :40].all() and missing.sum() == 180
    assert found.outliers == pytest.approx(100 / (60 * 80 - 80))
    assert found.rms < 1e-9


@pytest.mark.parametrize(
    "depth", [np.zeros((20, 20)), np.where(np.arange(20) == 3, 1.0, 0.0) * np.ones((20, 1))]
)
def test_no_plane_is_refused(depth):
    with pytest.raises(ValueError, match="depth: found"):
        plane_residual(depth, 40.0)


def test_variogram_of_white_noise_is_its_variance_and_of_a_ramp_grows():
    noise = np.random.default_rng(0).normal(0, 0.3, (100, 120))
    noise[::7, ::5] = np.nan
    np.testing.assert_allclose(variogram(noise), 0.09, rtol=0.06)
    ramp = np.broadcast_to(np.arange(50.0), (50, 50))
    np.testing.assert_allclose(variogram(ramp), [0.5 * LAGS**2, 0 * LAGS])


def test_a_patch_that_is_too_small_has_no_figure():
    assert np.isnan(variogram(np.zeros((10, 50)))[1, LAGS >= 10]).all()


def test_blocks_are_all_of_it_once():
    image = np.arange(130 * 250.0).reshape(130, 250)
    cut = blocks(image, 60)
    assert len(cut) == 8
    np.testing.assert_array_equal(np.sort(np.concatenate([one.ravel() for one in cut])), image.ravel())
