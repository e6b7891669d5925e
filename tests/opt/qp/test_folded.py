"""More inequality rows than variables: folded into the metric, the same step and the same solutions."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from opt.qp import QPStatus, quadratic_program, solve_qp
from opt.qp.newton import folded_system, newton_system


@pytest.mark.parametrize("whole", [False, True])
@pytest.mark.parametrize("tasks", [0, 3])
def test_it_is_the_same_system(x64, whole, tasks):
    rng = np.random.default_rng(tasks)
    n, k = 5, 8
    half = rng.normal(size=(n, n))
    M = jnp.asarray(half @ half.T if whole else rng.uniform(0.1, 1, n))
    curvature, rows = jnp.asarray(rng.uniform(0, 10, n)), jnp.asarray(rng.normal(size=(tasks + k, n)))
    diagonal = jnp.concatenate([jnp.full(tasks, 1e-3), jnp.asarray(rng.uniform(0.1, 10, k))])
    g, h = jnp.asarray(rng.normal(size=n)), jnp.asarray(rng.normal(size=tasks + k))
    expected = newton_system(M, curvature, rows, diagonal, 0.0).solve(g, h)
    found = folded_system(M, curvature, rows, diagonal, tasks, 0.0).solve(g, h)
    for a, b in zip(found, expected, strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-6, atol=1e-7)


def test_rows_that_say_the_same_twice_change_nothing():
    """Six rows are few beside nine variables, twice six are many; their multipliers add up to the same."""
    rng = np.random.default_rng(1)
    A, b, c = rng.normal(size=(6, 9)), rng.uniform(0.01, 0.2, 6), rng.normal(size=9)

    def answer(times):
        rows, limit = np.tile(A, (times, 1)), np.tile(b, times)
        p = quadratic_program(jnp.full(9, 0.1), c, rows=rows, limit=limit, lower=-1.0, upper=1.0)
        return jax.jit(solve_qp)(p)

    once, twice = answer(1), answer(2)
    assert once.status == twice.status == QPStatus.SOLVED
    assert (np.asarray(once.dual.rows) > 0.01).sum() >= 2
    np.testing.assert_allclose(twice.value, once.value, atol=1e-5)
    np.testing.assert_allclose(twice.dual.rows.reshape(2, 6).sum(0), once.dual.rows, atol=1e-3)
