"""What two pictures share is told apart by what moved."""

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from sims.sensors.fixed_pattern import fixed_pattern, shared_covariance


def smooth(seed, sigma, shape=(400, 1240)):
    """A field that correlates as exp(-(d / 10)^2 / 2)."""
    field = gaussian_filter(np.random.default_rng(seed).normal(size=shape), 10 / np.sqrt(2), mode="wrap")
    return sigma * field / field.std()


def test_camera_surface_and_length_are_found():
    rng, camera, surface = np.random.default_rng(9), smooth(0, 0.08), smooth(1, 0.05)
    noise = rng.normal(0, 0.05, (2, *camera.shape))
    first, second = camera + surface + noise[0], camera + np.roll(surface, 20, axis=1) + noise[1]
    second[5:9, 30:60] = np.nan
    found = fixed_pattern(first, second, 20)
    assert found.camera == pytest.approx(0.08, rel=0.1)
    assert found.surface == pytest.approx(0.05, rel=0.15)
    assert found.length == pytest.approx(10, rel=0.1)
    assert found.shared == pytest.approx(0.083, rel=0.1)


def test_covariance_pairs_a_pixel_with_the_shifted_one():
    first = np.random.default_rng(0).normal(size=(50, 60))
    second = np.roll(first, (3, -5), (0, 1))
    assert shared_covariance(first, second, -5, 3) == pytest.approx(np.mean(first[:47, 5:] ** 2))
    assert abs(shared_covariance(first, second, 5, -3)) < 0.1
