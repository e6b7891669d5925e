"""The fit finds what `observe` put in, and rounding is as the formula says."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from sims.sensors import RGBD, Camera, DepthNoise, observe
from sims.sensors.noise_fit import (
    NoiseFit,
    bootstrap,
    fit_noise,
    noise_variogram,
    quantum_of,
    rounded_variogram,
)
from sims.sensors.plane_residual import LAGS, plane_residual, variogram

KINECT = Camera(fx=525.0, fy=525.0, width=240, height=120, baseline=0.075, near=0.1, far=9.0, decimation=1)
PRODUCT = 525 * 0.075


@pytest.fixture(scope="module")
def pictures():
    """Makes four pictures of a slanted wall at about 2.2 m."""
    v, u = np.indices((120, 240))
    depth = jnp.asarray(PRODUCT / (17 + 0.0104 * u - 0.0033 * v), float)
    whole = jnp.ones(depth.shape)
    wall = RGBD(depth, jnp.full((*depth.shape, 3), 0.5), whole, whole > 0)
    compiled = jax.jit(lambda noise, key: observe(wall, KINECT, noise, key=key).depth)

    def take(noise):
        return [np.asarray(compiled(noise, jax.random.key(k)), float) for k in range(4)]

    return take


@pytest.mark.parametrize(("sigma", "length", "quantum"), [(0.053, 3.1, 0.114), (0.08, 5.0, 1 / 32)])
def test_the_fit_finds_what_was_put_in(pictures, sigma, length, quantum):
    taken = pictures(DepthNoise(disparity_sigma=sigma, correlation=length, quantum=quantum))
    step = quantum_of(taken[0], PRODUCT)
    assert step == pytest.approx(quantum, rel=1e-4)
    fit = fit_noise([plane_residual(depth, PRODUCT) for depth in taken], step)
    assert fit.sigma == pytest.approx(sigma, rel=0.06)
    assert fit.correlation == pytest.approx(length, rel=0.06)
    assert fit.white < 0.1 * sigma
    assert (noise_variogram(fit)[1] < 0.05 * sigma**2).all()


def test_distortion_is_not_taken_for_noise(pictures):
    noise = DepthNoise(disparity_sigma=0.05, correlation=3.0, distortion=0.08, distortion_length=25.0)
    fit, low, high = bootstrap([plane_residual(d, PRODUCT) for d in pictures(noise)], 1 / 32, 30, seed=0)
    assert fit.sigma == pytest.approx(0.05, rel=0.1)
    assert fit.correlation == pytest.approx(3.0, rel=0.1)
    assert low.sigma < 0.05 < high.sigma and low.correlation < 3.0 < high.correlation
    assert fit.slow > 0.03 and fit.slow_length > 15


def test_quantum_is_found_though_depths_are_in_millimetres_and_none_where_there_is_none(pictures):
    coarse = pictures(DepthNoise(quantum=0.114))[0]
    assert quantum_of(np.rint(1000 * coarse) / 1000, PRODUCT) == pytest.approx(0.114, rel=0.01)
    assert quantum_of(pictures(DepthNoise(quantum=0.0))[0], PRODUCT) == 0


@pytest.mark.parametrize("sigma", [0.01, 0.05])
def test_rounding_changes_the_variogram_as_the_formula_says(sigma):
    rng, q, slope = np.random.default_rng(0), 0.1, 0.013
    before = NoiseFit(1e-9, 1.0, sigma, 1e-9, 8.0, q)
    exact = slope * np.arange(400) + rng.normal(0, sigma, (300, 400)) + rng.uniform(0, q, (300, 1))
    measured = variogram(q * np.rint(exact / q) - slope * np.arange(400))[0]
    expected = rounded_variogram(sum(noise_variogram(before)), slope * LAGS, q)
    np.testing.assert_allclose(measured, expected, rtol=0.02)


def test_patches_that_are_too_small_are_refused():
    small = plane_residual(np.ones((20, 20)) + 0.01 * np.arange(20), PRODUCT)
    with pytest.raises(ValueError, match="patches: found none"):
        fit_noise([small], 0.1)
