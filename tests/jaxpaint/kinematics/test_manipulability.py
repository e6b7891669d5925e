"""Manipulability and its gradient, and the small solver under both."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.compiling import batched
from jaxpaint.kinematics import jacobian, manipulability, manipulability_gradient, solve_spd
from sims.robots import load_robot


@pytest.mark.parametrize("n", [1, 3, 6])
def test_small_systems(n, x64, strict_ranks):
    rng = np.random.default_rng(n)
    root = rng.normal(size=(n, n))
    A, B = root @ root.T + 0.1 * np.eye(n), rng.normal(size=(n, 2))
    X, pivots = jax.jit(solve_spd)(jnp.asarray(A), jnp.asarray(B))
    np.testing.assert_allclose(A @ np.asarray(X), B, atol=1e-10)
    assert float(np.prod(pivots)) == pytest.approx(np.linalg.det(A), rel=1e-10)


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
    """For the whole robot, two slides and seven hinges, and for the arm's columns alone, added up."""
    robot = load_robot()

    def total(q, damping):
        J = jacobian(robot.chain, q)[1]
        return manipulability(J, damping) + 2 * manipulability(J[:, 3:], damping)

    def by_hand(q, damping):
        J = jacobian(robot.chain, q)[1]
        whole, arm = manipulability_gradient(J, damping)[1], manipulability_gradient(J[:, 3:], damping)[1]
        return whole.at[3:].add(2 * arm)  # where the base stands is all the same to the arm

    rng = np.random.default_rng(0)
    qs = np.asarray(robot.at_home(jnp.zeros(3))) + np.concatenate([np.zeros((1, 9)), rng.uniform(-1, 1, (7, 9))])
    damping = jnp.asarray([0.0, 1e-3] * 4)
    automatic = batched(jax.grad(total), in_axes=(0, 0), chunk=4)(jnp.asarray(qs), damping)
    assert float(jnp.abs(automatic).max()) > 0.01
    np.testing.assert_allclose(jax.jit(jax.vmap(by_hand))(jnp.asarray(qs), damping), automatic, atol=1e-9)


def test_a_stretched_arm_has_no_measure_and_a_finite_gradient():
    robot = load_robot()

    def read(q):
        return manipulability_gradient(jacobian(robot.chain, q)[1][:, 3:])

    m, gradient = jax.jit(read)(jnp.zeros(9))  # elbow stretched and wrist aligned
    assert 0 <= float(m) < 1e-3 and bool(jnp.isfinite(gradient).all())
