"""S1-(1) to (3) against what they say."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from nets.losses import LossWeights, distances, laplacian, loss

RNG = np.random.default_rng(0)


def test_distances_are_those_of_s1_1():
    """With Q sampled, so that the nearest point of the surface is the nearest sample."""
    cloud, truth = RNG.standard_normal((40, 3)), RNG.standard_normal((50, 3))
    valid, there = np.arange(40) < 30, np.arange(50) < 45
    apart = np.linalg.norm(cloud[valid][:, None] - truth[there], axis=-1)
    nearest = np.zeros((40, 3))
    nearest[valid] = truth[there][apart.argmin(1)]
    found = distances(*(jnp.asarray(x) for x in (cloud, valid, nearest, truth, there)))
    expected = [apart.min(1).mean(), apart.min(0).mean()]
    expected += [(apart.min(1) ** 2).mean(), (apart.min(0) ** 2).mean()]
    np.testing.assert_allclose(jax.tree.leaves(found), expected, rtol=1e-5)


def test_the_laplacian_is_that_of_s1_2():
    cloud = RNG.standard_normal((16, 3))
    means = [[np.delete(block, k, axis=0).mean(0) for k in range(8)] for block in cloud.reshape(2, 8, 3)]
    expected = ((cloud - np.reshape(means, (16, 3))) ** 2).sum(1).mean()
    assert float(laplacian(jnp.asarray(cloud), jnp.ones(16, bool))) == pytest.approx(expected, rel=1e-5)


def test_the_laplacian_counts_what_is_valid_alone():
    cloud = RNG.standard_normal((16, 3))
    valid = np.arange(16) < 4
    means = [np.delete(cloud[:4], k, axis=0).mean(0) for k in range(4)]
    expected = ((cloud[:4] - means) ** 2).sum(1).mean()
    assert float(laplacian(jnp.asarray(cloud), jnp.asarray(valid))) == pytest.approx(expected, rel=1e-5)
    lonely = np.arange(16) == 3
    assert float(laplacian(jnp.asarray(cloud), jnp.asarray(lonely))) == 0


def _at(factor):
    """Distances to a plane of points over it."""
    rng = np.random.default_rng(1)
    flat = np.column_stack([rng.random((64, 2)), np.zeros(64)])
    cloud = jnp.asarray(flat + [0, 0, 1] * (factor * 0.01 * rng.standard_normal((64, 1))))
    all_there = jnp.ones(64, bool)
    return distances(cloud, all_there, cloud * jnp.asarray([1, 1, 0]), jnp.asarray(flat), all_there)


def test_the_loss_is_a_share_of_the_raw_clouds():
    weights, raw = LossWeights(), _at(1.0)
    assert float(loss(weights, raw, raw, jnp.zeros(()))) == pytest.approx(2.0, rel=1e-4)
    assert float(loss(weights, raw, _at(0.5), jnp.zeros(()))) == pytest.approx(1.0, rel=1e-3)
    only = LossWeights(chamfer_l1=0.0, chamfer_l2=0.0, smoothness=3.0)
    assert float(loss(only, raw, raw, raw.there_squared)) == pytest.approx(3.0, rel=1e-4)


def test_gradients_are_finite_where_points_lie_on_the_surface(x64):
    flat = jnp.asarray(np.column_stack([RNG.random((16, 2)), np.zeros(16)]))
    there = jnp.ones(16, bool)

    def value(cloud):
        found = distances(cloud, there, cloud * jnp.asarray([1.0, 1.0, 0.0]), flat, there)
        return found.there + found.back + found.there_squared + found.back_squared

    gradient = jax.grad(value)(flat)
    assert np.isfinite(gradient).all()
    cloud = flat + jnp.asarray(0.01 * RNG.standard_normal((16, 3)))
    direction, step = jnp.asarray(RNG.standard_normal((16, 3))), 1e-7
    expected = (value(cloud + step * direction) - value(cloud - step * direction)) / (2 * step)
    np.testing.assert_allclose((jax.grad(value)(cloud) * direction).sum(), expected, rtol=1e-6)
