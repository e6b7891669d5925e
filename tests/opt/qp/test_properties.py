"""What must hold for every program, drawn by chance."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jaxpaint.compiling import batched
from opt.qp import QPStatus, solve_qp

COUNT = 16
SOLVE = {}


def solved(programs, seed, rows, dense):
    """Solutions of programs that have one; compiled once for each shape."""
    key = rows, dense
    if key not in SOLVE:
        SOLVE[key] = batched(lambda problem: solve_qp(problem), in_axes=(0,), chunk=COUNT)
    p = programs(COUNT, seed, rows=rows, dense=dense)
    return jax.tree.map(np.asarray, p), jax.tree.map(np.asarray, SOLVE[key](p))


@settings(max_examples=6)
@given(st.integers(0, 10_000), st.sampled_from([(0, False), (3, True)]))
def test_feasible_programs_are_solved_and_meet_the_conditions(programs, seed, shape):
    p, s = solved(programs, seed, *shape)
    assert (s.status == QPStatus.SOLVED).all()
    x, y, z = (a.astype(float) for a in (s.value, s.dual.task, s.dual.rows))
    force = np.einsum("nij,nj->ni", p.hessian, x) if shape[1] else p.hessian * x
    force = force + p.linear + np.einsum("nij,ni->nj", p.jacobian, y) + np.einsum("nij,ni->nj", p.rows, z)
    assert np.abs(force + s.dual.upper - s.dual.lower).max() < 1e-5
    assert np.abs(np.einsum("nij,nj->ni", p.jacobian, x) - p.target).max() < 1e-5
    assert (np.einsum("nij,nj->ni", p.rows, x) - p.limit).max(initial=-1) < 1e-5
    assert ((x >= p.lower) & (x <= p.upper)).all()
    assert (s.dual.upper >= 0).all() and (s.dual.lower >= 0).all() and (z >= 0).all()
    assert (s.dual.upper * (p.upper - x)).max() < 1e-6 and (s.dual.lower * (x - p.lower)).max() < 1e-6


def test_many_worlds_are_as_one(programs, solve, answer):
    p = programs(4, 8)
    many = solve(p)
    for i in range(4):
        alone = answer(jax.tree.map(lambda x, i=i: x[i], p))
        np.testing.assert_allclose(many.value[i], alone.value, atol=2e-6)


@pytest.mark.slow
def test_vmap_does_the_same(programs, solve):
    """What a GPU runs; XLA as it ships takes long over it on a CPU."""
    p = programs(32, 9)
    plain = jax.jit(jax.vmap(lambda problem: solve_qp(problem).value))(p)
    np.testing.assert_allclose(solve(p).value, plain, atol=5e-6)


def test_blocks_of_worlds_do_not_change_a_bit(programs, solve):
    p = programs(64, 10)
    p = eqx.tree_at(lambda q: q.target, p, p.target.at[::7].multiply(20.0))
    blocks = batched(lambda problem: solve_qp(problem), in_axes=(0,), chunk=64, block=32)(p)
    assert (np.asarray(blocks.status)[::7] == QPStatus.INFEASIBLE).all()
    jax.tree.map(np.testing.assert_array_equal, blocks, solve(p))


def test_a_dense_hessian_that_is_diagonal_is_the_same(programs, answer):
    one = jax.tree.map(lambda x: x[0], programs(1, 11))
    dense = eqx.tree_at(lambda q: q.hessian, one, jnp.diag(one.hessian))
    np.testing.assert_allclose(answer(one).value, answer(dense).value, atol=5e-6)
