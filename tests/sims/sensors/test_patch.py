"""A few pixels of depth: the truth, its noise, and what a camera cannot see."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.kinematics.pose import Pose
from sims.sensors import Camera, DepthNoise
from sims.sensors.patch import see_pixels

AHEAD = jnp.asarray([[0.0, 0, 1], [-1, 0, 0], [0, -1, 0]])  # z along x, x to the right, y down
RAYS = jnp.asarray([[0.0, 0.0, 1.0], [0.4, -0.2, 1.0], [-0.3, 0.3, 1.0]])
SEE = jax.jit(see_pixels)


def seen(plane, depth, noise, key=0):
    place = Pose(jnp.asarray([-depth, 0.0, 1.0]), AHEAD)
    return SEE(plane(), Camera(), noise, place, RAYS, key=jax.random.key(key))


def test_without_noise_it_is_the_depth(plane):
    depth, valid = seen(plane, 0.5, DepthNoise.zero())
    assert valid.all()
    np.testing.assert_allclose(depth, 0.5, rtol=1e-5)


def test_nearer_than_the_camera_measures_is_nothing(plane):
    assert not seen(plane, 0.19, DepthNoise.zero())[1].any()


def test_edge_on_is_nothing(plane):
    place = Pose(jnp.asarray([-0.5, 0.0, 1.0]), AHEAD)
    slanted = jnp.asarray([[6.0, 0.0, 1.0]])  # 80.5 degrees from the normal
    noise = DepthNoise()
    assert not SEE(plane(), Camera(), noise, place, slanted, key=jax.random.key(0))[1].any()


def test_noise_grows_with_the_square_of_depth(plane):
    spread = []
    for depth in (0.5, 1.0):
        many = [np.asarray(seen(plane, depth, DepthNoise(quantum=0.0), key=k)[0]) for k in range(200)]
        spread.append(np.std(many))
        expected = depth**2 * 0.08 / (111.7 * 4 * 0.05)
        assert spread[-1] == pytest.approx(expected, rel=0.12)
