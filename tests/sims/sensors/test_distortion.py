"""The fixed pattern: its statistics over cameras, and that it stays with the camera."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from sims.parameters import scalar
from sims.sensors import RGBD, Camera, DepthNoise, observe
from sims.sensors.distortion import distortion_field

FIELD = jax.jit(distortion_field, static_argnums=(0, 1), static_argnames="dtype")
CAMERA = Camera()
TRACES = []


@jax.jit
def compiled_observe(noise, key):
    """A wall across the optical axis at 1 m; notes each time it is traced."""
    TRACES.append(noise)
    shape = CAMERA.height, CAMERA.width
    wall = RGBD(jnp.ones(shape), jnp.full((*shape, 3), 0.5), jnp.ones(shape), jnp.ones(shape, bool))
    return observe(wall, CAMERA, noise, key=key).depth


def disparity_error(noise, key=0):
    product = float(CAMERA.fx) * CAMERA.decimation * float(CAMERA.baseline)
    return product / np.asarray(compiled_observe(noise, jax.random.key(key)), float) - product


def fixed(distortion, seed=0, length=20.0):
    return replace(
        DepthNoise.zero(),
        distortion=scalar(distortion),
        distortion_length=scalar(length),
        distortion_seed=jnp.asarray(seed, jnp.int32),
    )


def test_many_cameras_have_the_given_spread_and_length():
    length = jnp.asarray(10.0)
    samples = np.asarray([FIELD((60, 80), 1, length, jnp.asarray(k), dtype=jnp.float32) for k in range(100)])
    np.testing.assert_allclose(samples.mean(), 0, atol=0.05)
    np.testing.assert_allclose(samples.std(), 1, atol=0.05)
    for lag in (5, 10, 20):
        expected = np.exp(-0.5 * (lag / 10) ** 2)
        assert (samples[:, :, lag:] * samples[:, :, :-lag]).mean() == pytest.approx(expected, abs=0.06)
        assert (samples[:, lag:] * samples[:, :-lag]).mean() == pytest.approx(expected, abs=0.06)


def test_one_camera_has_about_the_spread_where_the_picture_is_wide():
    spread = [disparity_error(fixed(0.1, seed)).std() for seed in range(5)]
    np.testing.assert_allclose(spread, 0.1, rtol=0.15)


def test_length_is_in_pixels_of_the_full_sensor():
    fine = FIELD((120, 160), 1, jnp.asarray(20.0), jnp.asarray(3), dtype=jnp.float32)
    coarse = FIELD((30, 40), 4, jnp.asarray(20.0), jnp.asarray(3), dtype=jnp.float32)
    np.testing.assert_allclose(coarse, fine[::4, ::4], atol=1e-3)


def test_every_picture_of_a_camera_has_it_and_another_camera_another():
    np.testing.assert_array_equal(disparity_error(fixed(0.1), key=1), disparity_error(fixed(0.1), key=2))
    other = disparity_error(fixed(0.1, seed=1))
    assert abs(np.corrcoef(disparity_error(fixed(0.1)).ravel(), other.ravel())[0, 1]) < 0.5


def test_it_adds_to_the_noise_of_each_picture():
    noise = replace(fixed(0.1), disparity_sigma=scalar(0.05))
    first, second = disparity_error(noise, key=1), disparity_error(noise, key=2)
    assert np.std(first - second) == pytest.approx(0.05 * np.sqrt(2), rel=0.05)
    assert np.mean(first * second) == pytest.approx(np.mean(disparity_error(fixed(0.1)) ** 2), rel=0.1)


def test_sweeping_it_does_not_trace_again_and_off_is_nothing():
    np.testing.assert_allclose(disparity_error(fixed(0.0)), 0, atol=1e-5)
    before = len(TRACES)
    for values in ((0.1, 1, 5.0), (0.2, 7, 50.0), (0.0, 2, 0.0)):
        assert np.isfinite(disparity_error(fixed(*values))).all()
    assert len(TRACES) == before > 0


def test_presets_are_calibrated():
    assert DepthNoise().distortion == DepthNoise.zero().distortion == 0
