"""The QP against its optimality conditions, against finite differences, and on bad problems."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.compiling import batched
from opt.qp import QPStatus, QuadraticProgram, solve_qp

CASES = 64


def problems(count=CASES, seed=0, dtype=np.float32, slack=1e4) -> QuadraticProgram:
    rng = np.random.default_rng(seed)
    arrays = (
        np.full((count, 9), 0.01),
        rng.normal(size=(count, 9)) * 0.02,
        rng.normal(size=(count, 6, 9)) * np.r_[np.ones(3), np.full(6, 0.5)],
        rng.normal(size=(count, 6)) * 0.15,
        np.full((count, 6), slack),
        -rng.uniform(0.15, 1.0, (count, 9)),
        rng.uniform(0.15, 1.0, (count, 9)),
    )
    return QuadraticProgram(*(jnp.asarray(a, dtype) for a in arrays))


SOLVE = batched(lambda problem: solve_qp(problem), in_axes=(0,), chunk=32)


def test_meets_the_optimality_conditions():
    """x minimises: a projected gradient step from x does not move it."""
    p = problems()
    solution = SOLVE(p)
    assert (np.asarray(solution.status) == QPStatus.SOLVED).all()
    x = np.asarray(solution.value, float)
    J, lam = np.asarray(p.jacobian, float), np.asarray(p.slack_cost, float)
    miss = np.einsum("nij,nj->ni", J, x) - np.asarray(p.target)
    gradient = np.asarray(p.cost) * x + np.asarray(p.linear) + np.einsum("nij,ni->nj", J, lam * miss)
    stepped = np.clip(x - 1e-5 * gradient, p.lower, p.upper)
    assert np.abs(stepped - x).max() < 1e-5
    assert (x >= np.asarray(p.lower)).all() and (x <= np.asarray(p.upper)).all()


def test_bad_problems_get_a_status_and_leave_the_others_alone():
    good = SOLVE(problems())
    p = problems()
    nan = p.target.at[3, 2].set(jnp.nan)
    crossed = p.lower.at[5, 1].set(2.0)
    pinned_low, pinned_high = crossed.at[7].set(0.0), p.upper.at[7].set(0.0)
    solution = SOLVE(
        QuadraticProgram(p.cost, p.linear, p.jacobian, nan, p.slack_cost, pinned_low, pinned_high)
    )
    status = np.asarray(solution.status)
    assert status[3] == QPStatus.NOT_FINITE
    assert status[5] == QPStatus.INFEASIBLE
    assert status[7] == QPStatus.SOLVED
    np.testing.assert_array_equal(solution.value[7], 0)
    assert np.isfinite(np.asarray(solution.value)).all()
    rest = np.setdiff1d(np.arange(CASES), [3, 5, 7])
    np.testing.assert_array_equal(np.asarray(solution.value)[rest], np.asarray(good.value)[rest])


@pytest.mark.parametrize("smoothing", [1e-3, 1e-2])
def test_gradients_agree_with_differences_and_forward_with_reverse(x64, smoothing):
    p = problems(4, seed=1, dtype=np.float64, slack=1e3)
    weight = jnp.asarray(np.random.default_rng(2).normal(size=9))

    def value(problem):
        return (weight * solve_qp(problem, smoothing=smoothing, iterations=25).value).sum()

    one = jax.tree.map(lambda x: x[0], p)
    gradient = jax.grad(value)(one)
    tangent = jax.tree.map(lambda x: jnp.asarray(np.random.default_rng(3).normal(size=x.shape)) * x, one)
    forward = jax.jvp(value, (one,), (tangent,))[1]
    reverse = sum(
        jnp.sum(a * b) for a, b in zip(jax.tree.leaves(gradient), jax.tree.leaves(tangent), strict=True)
    )
    h = 1e-6
    ahead = value(jax.tree.map(lambda x, t: x + h * t, one, tangent))
    behind = value(jax.tree.map(lambda x, t: x - h * t, one, tangent))
    np.testing.assert_allclose(reverse, forward, rtol=1e-9)
    np.testing.assert_allclose(forward, (ahead - behind) / (2 * h), rtol=1e-5)
