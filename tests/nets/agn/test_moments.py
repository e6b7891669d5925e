"""Moments of sets, and the planes through them."""

import jax
import jax.numpy as jnp
import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from nets.agn.moments import Moments, across, normal_of, of_points, of_sets

RNG = np.random.default_rng(0)


def weights(*shape):
    rows = RNG.random(shape)
    return jnp.asarray(rows / rows.sum(-1, keepdims=True))


def test_moments_are_mean_and_covariance():
    points, weight = RNG.standard_normal((5, 20, 3)), weights(5, 20)
    found = of_points(weight, jnp.asarray(points))
    for k in range(5):
        np.testing.assert_allclose(
            found.centre[k], np.average(points[k], axis=0, weights=weight[k]), atol=1e-6
        )
        expected = np.cov(points[k].T, aweights=np.asarray(weight[k]), ddof=0)
        np.testing.assert_allclose(found.covariance[k], expected, atol=1e-6)


def test_a_union_is_as_if_all_points_had_been_taken():
    points, inner, outer = jnp.asarray(RNG.standard_normal((4, 10, 3))), weights(4, 10), weights(1, 4)
    parts = of_points(inner, points)
    found = of_sets(outer, jax.tree.map(lambda leaf: leaf[None], parts))
    whole = of_points((outer[0][:, None] * inner).reshape(1, -1), points.reshape(1, -1, 3))
    np.testing.assert_allclose(found.centre, whole.centre, atol=1e-6)
    np.testing.assert_allclose(found.covariance, whole.covariance, atol=1e-6)


@given(st.integers(0, 2**31))
def test_the_normal_is_the_axis_of_least_variance(seed):
    rng = np.random.default_rng(seed)
    axes = np.linalg.qr(rng.standard_normal((3, 3)))[0]
    points = (rng.standard_normal((30, 3)) * [1, 0.6, 0.02]) @ axes.T
    moments = of_points(jnp.full((1, 30), 1 / 30), jnp.asarray(points[None]))
    guess = rng.standard_normal(3)
    normal = normal_of(moments, jnp.asarray(guess / np.linalg.norm(guess))[None])[0]
    values, vectors = np.linalg.eigh(np.cov(points.T, ddof=0))
    assert abs(normal @ vectors[:, 0]) > 1 - 1e-4 and normal @ guess >= -1e-6
    np.testing.assert_allclose(across(moments, normal[None])[0], values[0], rtol=0.05)


def test_what_determines_no_plane_gives_a_finite_normal_and_gradient():
    line = np.linspace(0, 1, 8)[:, None] * [1.0, 2.0, 3.0]
    for points in (np.zeros((8, 3)), line):

        def normal(points):
            moments = of_points(jnp.full((1, 8), 1 / 8), points[None])
            return normal_of(moments, jnp.asarray([[0.0, 0.0, 1.0]])).sum()

        value, gradient = jax.value_and_grad(normal)(jnp.asarray(points))
        assert np.isfinite(value) and np.isfinite(gradient).all()


def test_moments_can_be_picked():
    moments = Moments(jnp.arange(6.0).reshape(2, 3), jnp.zeros((2, 3, 3)))
    assert moments[jnp.asarray([[1, 0, 1]])].centre.shape == (1, 3, 3)
