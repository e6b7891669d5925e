"""The QP against its optimality conditions, and on bad problems."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np

from opt.qp import QPStatus

CASES = 64


def optimality(program, x):
    """How far a projected step of steepest descent moves x: 0 at the minimum of a program of soft rows."""
    J, compliance = np.asarray(program.jacobian, float), np.asarray(program.compliance, float)
    miss = np.einsum("nij,nj->ni", J, x) - np.asarray(program.target)
    gradient = np.asarray(program.hessian) * x + np.asarray(program.linear)
    gradient = gradient + np.einsum("nij,ni->nj", J, miss / compliance)
    return np.clip(x - 1e-5 * gradient, program.lower, program.upper) - x


def test_meets_the_optimality_conditions(programs, solve):
    p = programs(CASES, 0, compliance=1e-4)
    solution = solve(p)
    assert (np.asarray(solution.status) == QPStatus.SOLVED).all()
    x = np.asarray(solution.value, float)
    assert np.abs(optimality(p, x)).max() < 1e-5
    assert (x >= np.asarray(p.lower)).all() and (x <= np.asarray(p.upper)).all()


def test_bad_problems_get_a_status_and_leave_the_others_alone(programs, solve):
    p = programs(CASES, 0)
    good = solve(p)
    bad = eqx.tree_at(
        lambda q: (q.target, q.lower, q.upper),
        p,
        (
            p.target.at[3, 2].set(jnp.nan).at[7].set(0.0),
            p.lower.at[5, 1].set(2.0).at[7].set(0.0),
            p.upper.at[7].set(0.0),
        ),
    )
    solution = solve(bad)
    status = np.asarray(solution.status)
    assert status[3] == QPStatus.NOT_FINITE
    assert status[5] == QPStatus.INFEASIBLE
    assert status[7] == QPStatus.SOLVED
    np.testing.assert_allclose(solution.value[7], 0, atol=1e-6)
    assert np.isfinite(np.asarray(solution.value)).all()
    rest = np.setdiff1d(np.arange(CASES), [3, 5, 7])
    np.testing.assert_array_equal(np.asarray(solution.value)[rest], np.asarray(good.value)[rest])
