"""Chamfer distances against a k-d tree, in the conventions stated."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.spatial import KDTree

from sims.scoring import chamfer, surface_samples

CHAMFER = jax.jit(chamfer)
SAMPLES = jax.jit(surface_samples, static_argnames=("columns", "rows"))


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


def test_small_offsets_far_from_the_origin_survive_single_precision(plane):
    chart = plane().chart
    truth = SAMPLES(chart, jnp.asarray([-1.0, 0.5]), jnp.asarray([1.0, 1.5]), columns=30, rows=15)
    cloud = truth + jnp.asarray([1e-4, 0, 0])
    found = CHAMFER(cloud, jnp.ones(450, bool), truth)
    assert found.l1 == pytest.approx(1e-4, rel=1e-3)
    assert found.l2 == pytest.approx(2e-8, rel=1e-3)


def test_samples_lie_evenly_on_the_surface(pillar):
    points = SAMPLES(pillar.chart, jnp.asarray([-0.3, 0.0]), jnp.asarray([0.3, 1.0]), columns=6, rows=4)
    assert points.shape == (24, 3)
    np.testing.assert_allclose(np.hypot(points[:, 0] - 0.5, points[:, 1]), 0.5, rtol=1e-5)
    first_row = np.asarray(points[:6])
    np.testing.assert_allclose(
        np.arctan2(-first_row[:, 1], 0.5 - first_row[:, 0]) * 0.5, np.arange(-0.25, 0.3, 0.1), atol=1e-5
    )


def test_without_points_there_is_no_figure():
    cloud, truth = clouds()
    found = CHAMFER(jnp.asarray(cloud), jnp.zeros(300, bool), jnp.asarray(truth))
    assert np.isinf([found.l1, found.l2]).all()


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
