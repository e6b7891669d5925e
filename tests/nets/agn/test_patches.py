"""Clouds of any size, by patches."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
import pytest

from nets.agn import refine, residuals
from tests.nets.agn.conftest import corner

PATCH = 512
REFINE = eqx.filter_jit(refine)


def run(network, points, **given):
    return np.asarray(REFINE(network, jnp.asarray(points, jnp.float32), patch=PATCH, **given))


def plane(count):
    rng = np.random.default_rng(0)
    return np.column_stack([rng.uniform(-1, 1, (count, 2)), 3 + 0.01 * rng.standard_normal(count)])


def test_a_small_cloud_is_one_patch(network):
    points = corner(PATCH, 0.01)[0].astype(np.float32)
    alone = eqx.filter_jit(residuals)(network, jnp.asarray(points), jnp.ones(PATCH, bool))
    np.testing.assert_allclose(run(network, points), points + alone, atol=1e-6)


@pytest.mark.parametrize("count", [10, 3000])
def test_any_number_of_points_gets_smoother(network, count):
    points = plane(count)
    refined = run(network, points)
    assert refined.shape == points.shape and np.isfinite(refined).all()
    assert refined[:, 2].std() < (0.95 if count < 100 else 0.3) * points[:, 2].std()


def test_patches_meet_without_seams(network):
    """Where two patches meet a plane is as smooth as elsewhere: no point stands out."""
    refined = run(network, plane(3000))
    rest = refined[:, 2] - 3
    assert np.abs(rest).max() < 8 * rest.std()


def test_points_that_are_no_numbers_stay_and_touch_nobody(network):
    points = plane(600).astype(np.float32)
    broken = points.copy()
    broken[::7] = np.nan
    refined = run(network, broken)
    assert np.isnan(refined[::7]).all()
    kept = np.ones(600, bool)
    kept[::7] = False
    assert np.isfinite(refined[kept]).all()
    again = run(network, np.where(kept[:, None], points, 1e5), valid=jnp.asarray(kept))
    np.testing.assert_allclose(refined[kept], again[kept], atol=1e-6)
    np.testing.assert_array_equal(again[~kept], np.float32(1e5))


def test_a_cloud_of_one_point_many_times(network):
    points = np.ones((700, 3))
    np.testing.assert_allclose(run(network, points), points, atol=1e-5)
