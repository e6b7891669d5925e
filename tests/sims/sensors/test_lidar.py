"""The scanner before a flat wall."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.kinematics import Pose
from jaxpaint.kinematics.rotations import exponential
from sims.sensors import Lidar, scan

SCAN = jax.jit(scan)
POSITION = jnp.asarray([-2.0, 0.4, 0.2])


def level(yaw):
    return Pose(POSITION, exponential(jnp.asarray([0.0, 0.0, yaw])))


def test_a_tilted_scanner_looks_further_down(plane):
    lidar = Lidar(first=-0.1, last=0.1, sigma=0.0, dropout=0.0, beams=3)
    down = Pose(POSITION, exponential(jnp.asarray([0.0, 0.3, 0.0])))
    ranges, _ = SCAN(plane(), lidar, down, key=jax.random.key(0))
    np.testing.assert_allclose(ranges[1], 2 / np.cos(0.3), rtol=1e-4)


def test_clean_ranges_follow_the_bearings(plane):
    lidar = replace(Lidar(), sigma=jnp.asarray(0.0), dropout=jnp.asarray(0.0))
    ranges, valid = SCAN(plane(), lidar, level(0.3), key=jax.random.key(0))
    heading = np.asarray(lidar.bearings) + 0.3
    expected = 2 / np.cos(heading)
    ahead = (np.cos(heading) > 0) & (expected < 20)
    np.testing.assert_array_equal(valid, ahead)
    np.testing.assert_allclose(np.asarray(ranges)[ahead], expected[ahead], rtol=1e-4)
    assert (np.asarray(ranges)[~ahead] == 0).all()


def test_noise_and_dropout_have_the_given_size(plane):
    lidar = Lidar(first=-0.5, last=0.5, sigma=0.02, dropout=0.1, beams=20000)
    ranges, valid = SCAN(plane(), lidar, level(0.0), key=jax.random.key(0))
    kept = np.asarray(valid)
    assert 1 - kept.mean() == pytest.approx(0.1, abs=0.01)
    error = (np.asarray(ranges) - 2 / np.cos(np.asarray(lidar.bearings)))[kept]
    assert error.std() == pytest.approx(0.02, rel=0.03)
