"""Chamfer distances against brute force, a k-d tree and figures by hand, in the conventions stated."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.spatial import KDTree

from jaxpaint.clouds import chamfer, chamfer_by_tree

CHAMFER = jax.jit(chamfer)


def clouds(points=300, samples=190):
    rng = np.random.default_rng(0)
    corner = np.asarray([3, 0, 1])
    return rng.uniform(corner, corner + 2, (points, 3)), rng.uniform(corner, corner + 2, (samples, 3))


def test_agrees_with_a_tree():
    cloud, truth = clouds()
    valid = np.arange(300) % 3 > 0
    found = CHAMFER(jnp.asarray(cloud), jnp.asarray(valid), jnp.asarray(truth))
    there = KDTree(truth).query(cloud[valid])[0]
    back = KDTree(cloud[valid]).query(truth)[0]
    assert found.l2 == pytest.approx((there**2).mean() + (back**2).mean(), rel=1e-4)
    assert found.l1 == pytest.approx(0.5 * (there.mean() + back.mean()), rel=1e-4)


def test_the_host_agrees_with_all_pairs():
    cloud, truth = clouds()
    distance = np.linalg.norm(cloud[:, None] - truth[None], axis=-1)
    there, back = distance.min(1), distance.min(0)
    found = chamfer_by_tree(cloud, truth)
    assert found.l2 == pytest.approx((there**2).mean() + (back**2).mean(), rel=1e-12)
    assert found.l1 == pytest.approx(0.5 * (there.mean() + back.mean()), rel=1e-12)


@pytest.mark.parametrize("which", ["device", "host"])
def test_by_hand(which: str):
    # there: 1 and 2, nearest (0, 0, 0) and (3, 0, 0); back: 1, 2 and 4
    cloud = np.asarray([[0, 1, 0], [3, 2, 0]], np.float32)
    truth = np.asarray([[0, 0, 0], [3, 0, 0], [0, 5, 0]], np.float32)
    found = chamfer_by_tree(cloud, truth) if which == "host" else CHAMFER(cloud, np.ones(2, bool), truth)
    back = [1.0, 2.0, 4.0]
    assert found.l1 == pytest.approx(0.5 * (1.5 + np.mean(back)))
    assert found.l1_sum == pytest.approx(1.5 + np.mean(back))
    assert found.l2 == pytest.approx(2.5 + np.mean(np.square(back)))


def test_without_points_there_is_no_figure():
    cloud, truth = clouds()
    for found in (
        CHAMFER(jnp.asarray(cloud), jnp.zeros(300, bool), jnp.asarray(truth)),
        chamfer_by_tree(cloud[:0], truth),
    ):
        assert np.isinf([found.l1, found.l2]).all()
    with pytest.raises(ValueError, match="truth"):
        chamfer_by_tree(cloud, truth[:0])


def test_gradients_agree_with_central_differences(x64):
    cloud, truth = clouds(40, 30)
    cloud[0] = truth[0]
    valid = jnp.arange(40) < 35
    way = np.random.default_rng(1).normal(size=cloud.shape)
    way[0] = 0  # a point on its target: a kink of the plain distance, where the gradient is set to 0

    @jax.jit
    def figures(points):
        found = chamfer(points, valid, jnp.asarray(truth))
        return jnp.stack([found.l1, found.l2])

    slopes = np.asarray(figures(cloud + 1e-6 * way) - figures(cloud - 1e-6 * way)) / 2e-6
    gradients = np.asarray(jax.jit(jax.jacrev(figures))(cloud))
    assert np.isfinite(gradients).all()
    np.testing.assert_allclose((gradients * way).sum((1, 2)), slopes, rtol=1e-5)
