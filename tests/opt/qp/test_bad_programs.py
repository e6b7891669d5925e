"""Programs without a solution, without numbers, without full rank: an answer and a status, never NaN."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.optimize import lsq_linear

from jaxpaint.compiling import batched
from opt.qp import QPStatus, quadratic_program, solve_qp

INPUTS = ("hessian", "linear", "jacobian", "target", "compliance", "rows", "limit", "lower", "upper")


def test_infeasible_programs_get_the_least_violation(programs, solve):
    p = programs(32, 3)
    p = eqx.tree_at(lambda q: q.target, p, p.target * 10)
    s = solve(p)
    J, v, lower, upper = (np.asarray(a, float) for a in (p.jacobian, p.target, p.lower, p.upper))
    least = [lsq_linear(J[i], v[i], (lower[i], upper[i]), method="bvls").fun for i in range(32)]
    least = np.linalg.norm(least, axis=1)
    infeasible = least > 1e-5
    assert infeasible.sum() > 16
    np.testing.assert_array_equal(np.asarray(s.status) == QPStatus.INFEASIBLE, infeasible)
    found = np.linalg.norm(np.einsum("nij,nj->ni", J, np.asarray(s.value, float)) - v, axis=1)
    np.testing.assert_allclose(found[infeasible], least[infeasible], rtol=1e-3, atol=1e-4)


def test_a_fixed_number_of_steps_recognises_them_too(programs):
    p = programs(16, 3)
    p = eqx.tree_at(lambda q: q.target, p, p.target * 30)
    s = batched(lambda problem: solve_qp(problem, iterations=10, fixed=True), in_axes=(0,), chunk=8)(p)
    assert (np.asarray(s.status) == QPStatus.INFEASIBLE).all()
    assert np.isfinite(np.asarray(s.value)).all()
    assert (np.asarray(s.iterations) == 10).all()


def test_soft_rows_are_never_infeasible(programs, solve):
    p = programs(32, 3, compliance=1e-3)
    p = eqx.tree_at(lambda q: q.target, p, p.target * 30)
    assert (np.asarray(solve(p).status) == QPStatus.SOLVED).all()


@pytest.mark.parametrize("name", INPUTS)
def test_nan_in_one_world_leaves_the_bits_of_the_others(programs, solve, name):
    p = programs(32, 4, rows=2 if name in ("rows", "limit") else 0)
    good = solve(p)
    leaf = getattr(p, name)
    bad = eqx.tree_at(lambda q: getattr(q, name), p, leaf.at[(5, *[0] * (leaf.ndim - 1))].set(jnp.nan))
    s = solve(bad)
    assert s.status[5] == QPStatus.NOT_FINITE
    assert all(np.isfinite(x[5]).all() for x in jax.tree.leaves((s.value, s.dual)))
    rest = np.arange(32) != 5
    jax.tree.map(
        lambda a, b: np.testing.assert_array_equal(np.asarray(a)[rest], np.asarray(b)[rest]), s, good
    )


def test_nan_gives_no_derivative_that_is_nan(programs):
    p = programs(2, 5)
    p = eqx.tree_at(lambda q: q.target, p, p.target.at[0, 0].set(jnp.nan))
    gradient = batched(jax.grad(lambda problem: solve_qp(problem).value.sum()), in_axes=(0,), chunk=1)(p)
    assert all(np.isfinite(x).all() for x in jax.tree.leaves(gradient))


def test_contradictory_bounds_are_infeasible_and_infinite_ones_are_no_bounds(answer):
    free = quadratic_program(jnp.ones(3), jnp.array([1.0, -2.0, 3.0]))
    s = answer(free)
    assert s.status == QPStatus.SOLVED
    np.testing.assert_allclose(s.value, [-1, 2, -3], rtol=1e-5)
    crossed = answer(quadratic_program(jnp.ones(3), jnp.zeros(3), lower=1.0, upper=0.0))
    assert crossed.status == QPStatus.INFEASIBLE
    assert np.isfinite(crossed.value).all()
    nowhere = answer(quadratic_program(jnp.ones(3), jnp.zeros(3), lower=jnp.inf))
    assert nowhere.status == QPStatus.NOT_FINITE


@pytest.mark.parametrize("whole", [False, True])
def test_a_cost_that_falls_for_ever_is_said_to(answer, whole):
    flat = jnp.asarray([0.0, 1.0, 1.0])
    M = jnp.diag(flat) if whole else flat
    s = answer(quadratic_program(M, jnp.array([1.0, 0.0, 0.0]), upper=2.0))
    assert s.status == QPStatus.UNBOUNDED
    held = answer(quadratic_program(M, jnp.array([1.0, 0.0, 0.0]), lower=-2.0))
    assert held.status == QPStatus.SOLVED
    np.testing.assert_allclose(held.value, [-2, 0, 0], atol=1e-4)


@pytest.mark.parametrize("bad", [{"hessian": -1.0}, {"compliance": -1e-3}])
def test_negative_weights_are_not_convex(answer, bad):
    """One that is not convex is told from one that is not finite, and leaves no derivative."""

    def program(scale):
        return quadratic_program(
            jnp.asarray([bad.get("hessian", 1.0), 1.0, 1.0]),
            scale * jnp.ones(3),
            jacobian=jnp.eye(3)[:1],
            target=jnp.ones(1),
            compliance=bad.get("compliance", 1e-3),
            lower=-2.0,
            upper=2.0,
        )

    s = answer(program(1.0))
    assert s.status == QPStatus.NOT_CONVEX
    np.testing.assert_array_equal(s.value, 0)
    slope = jax.jacfwd(lambda scale: solve_qp(program(scale)).value)(1.0)
    np.testing.assert_array_equal(slope, 0)


def test_dependent_rows_that_agree_are_solved_and_that_do_not_are_infeasible(answer):
    J = jnp.array([[1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 0.0]])
    agree = quadratic_program(
        jnp.ones(3), jnp.zeros(3), jacobian=J, target=jnp.array([1.0, 1.0, 0.0]), lower=-2.0, upper=2.0
    )
    s = answer(agree)
    assert s.status == QPStatus.SOLVED
    np.testing.assert_allclose(s.value, [0.5, 0.5, 0], atol=1e-5)
    s = answer(eqx.tree_at(lambda q: q.target, agree, jnp.array([1.0, 0.0, 0.0])))
    assert s.status == QPStatus.INFEASIBLE
    np.testing.assert_allclose(s.value[0] + s.value[1], 0.5, atol=1e-4)


def test_shapes_that_do_not_fit_are_refused():
    with pytest.raises(ValueError, match="target: found shape"):
        quadratic_program(jnp.ones(3), jnp.zeros(3), jacobian=jnp.ones((2, 3)), target=jnp.ones(3))


@pytest.mark.parametrize("compliance", [0.0, 1e-4])
@pytest.mark.parametrize("fixed", [False, True])
def test_rows_may_be_all_that_is_asked_for(compliance, fixed):
    """M and c are zero: every x that meets the rows is a solution."""
    v = jnp.asarray([0.1, -0.2])
    p = quadratic_program(
        jnp.zeros(3),
        jnp.zeros(3),
        jacobian=jnp.eye(3)[:2],
        target=v,
        compliance=compliance,
        lower=-1.0,
        upper=1.0,
    )
    s = solve_qp(p, fixed=fixed, iterations=12 if fixed else 25)
    assert s.status == QPStatus.SOLVED
    np.testing.assert_allclose(s.value[:2], v, atol=1e-4)


@pytest.mark.parametrize("huge", [{"smoothing": jnp.nan}, {"scale": 1e25}])
def test_what_overflows_is_not_finite_and_zero(huge):
    J = huge.get("scale", 1.0) * jnp.eye(3)
    p = quadratic_program(jnp.ones(3), jnp.zeros(3), jacobian=J, target=jnp.ones(3), lower=-1.0, upper=1.0)
    s = solve_qp(p, smoothing=huge.get("smoothing", 0.0))
    assert s.status == QPStatus.NOT_FINITE
    np.testing.assert_array_equal(s.value, 0)
