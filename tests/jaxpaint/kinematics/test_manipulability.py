"""Manipulability and its gradient, and the small solver under both."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.kinematics import jacobian, manipulability, manipulability_gradient, solve_spd
from jaxpaint.kinematics.small_solve import inverse_spd
from sims.robots import load_robot


@pytest.mark.parametrize("n", [1, 3, 6])
def test_small_systems(n, x64, strict_ranks):
    rng = np.random.default_rng(n)
    root = rng.normal(size=(n, n))
    A, B = root @ root.T + 0.1 * np.eye(n), rng.normal(size=(n, 2))
    X, pivots = jax.jit(solve_spd)(jnp.asarray(A), jnp.asarray(B))
    np.testing.assert_allclose(A @ np.asarray(X), B, atol=1e-10)
    assert float(np.prod(pivots)) == pytest.approx(np.linalg.det(A), rel=1e-10)


def test_an_inverse_and_its_root_change_as_differences_say(x64, strict_ranks):
    rng = np.random.default_rng(1)
    root, change, weight = rng.normal(size=(3, 5, 5))
    A, change = jnp.asarray(root @ root.T + np.eye(5)), jnp.asarray(change + change.T)

    def total(length):
        inverse, root = inverse_spd(A + length * change)
        return (inverse * weight).sum() + root

    value = jax.jit(total)
    np.testing.assert_allclose(inverse_spd(A)[0] @ A, np.eye(5), atol=1e-12)
    assert float(inverse_spd(A)[1]) == pytest.approx(np.sqrt(np.linalg.det(A)))
    numeric = float(value(1e-6) - value(-1e-6)) / 2e-6
    assert float(jax.jit(jax.grad(total))(0.0)) == pytest.approx(numeric, rel=1e-7)


def test_a_singular_system_is_finite_and_so_is_its_gradient():
    def total(A):
        X, pivots = solve_spd(A, jnp.ones((3, 1), A.dtype))
        return X.sum() + jnp.sqrt(pivots).prod()

    value, slope = jax.jit(jax.value_and_grad(total))(jnp.zeros((3, 3)).at[0, 0].set(1.0))
    assert bool(jnp.isfinite(value)) and bool(jnp.isfinite(slope).all())


def test_the_measure_is_the_product_of_singular_values(x64):
    rng = np.random.default_rng(0)
    for joints in (6, 7, 9):
        J = rng.normal(size=(6, joints))
        measure = jax.jit(manipulability)(jnp.asarray(J), 0.0)
        assert float(measure) == pytest.approx(np.prod(np.linalg.svd(J)[1]), rel=1e-10)


def test_the_gradient_is_that_of_differentiation(x64):
    """Of the whole robot, two slides among it, and of the arm alone: dm = m tr(A^-1 dJ J^T), dJ by JAX."""
    robot, damping = load_robot(), 1e-4

    @jax.jit
    @jax.vmap
    def read(q):
        J, dJ = jacobian(robot.chain, q)[1], jax.jacfwd(lambda q: jacobian(robot.chain, q)[1])(q)
        return J, dJ, [manipulability_gradient(J[:, first:], damping) for first in (0, 3)]

    q = np.asarray(robot.at_home(jnp.zeros(3))) + np.random.default_rng(0).uniform(-1, 1, (6, 9))
    whole_J, whole_dJ, found = jax.tree.map(np.asarray, read(jnp.asarray(q)))
    for first, (m, gradient) in zip((0, 3), found, strict=True):
        J, dJ = whole_J[:, :, first:], whole_dJ[:, :, first:, first:]
        A = J @ J.transpose(0, 2, 1) + damping * np.eye(6)
        np.testing.assert_allclose(m, np.sqrt(np.linalg.det(A)), rtol=1e-10)
        expected = m[:, None] * np.einsum("nab,nbik,nai->nk", np.linalg.inv(A), dJ, J)
        assert np.abs(expected).max() > 0.01
        np.testing.assert_allclose(gradient, expected, atol=1e-11)


def test_a_stretched_arm_has_no_measure_and_a_finite_gradient():
    robot = load_robot()
    J = jax.jit(jacobian)(robot.chain, jnp.zeros(9))[1][:, 3:]  # elbow stretched and wrist aligned
    m, gradient = jax.jit(manipulability_gradient)(J)
    assert 0 <= float(m) < 1e-3 and bool(jnp.isfinite(gradient).all())
