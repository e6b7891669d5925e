"""A start from an earlier solution saves steps and never costs an answer."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.compiling import batched
from opt.qp import QPStatus, solve_qp

COUNT = 64
WARM = batched(lambda problem, start: solve_qp(problem, start=start), in_axes=(0, 0), chunk=32)


def test_near_programs_take_fewer_steps(programs, solve):
    p = programs(COUNT, 20)
    earlier = solve(p)
    near = eqx.tree_at(lambda q: (q.linear, q.target), p, (p.linear * 1.01, p.target * 0.99))
    cold, warm = solve(near), WARM(near, earlier)
    np.testing.assert_array_equal(warm.status, cold.status)
    np.testing.assert_allclose(warm.value, cold.value, atol=1e-5)
    assert np.asarray(warm.iterations).mean() < np.asarray(cold.iterations).mean() - 2


@pytest.mark.parametrize("harm", [np.nan, 1e9, -1e9, 0.0])
def test_a_useless_start_costs_no_answer(programs, solve, harm):
    p = programs(COUNT, 21)
    p = eqx.tree_at(lambda q: q.target, p, p.target.at[::5].multiply(20.0))
    cold = solve(p)
    start = jax.tree.map(lambda x: jnp.full_like(x, harm) if x.dtype == jnp.float32 else x, cold)
    warm = WARM(p, start)
    np.testing.assert_array_equal(warm.status, cold.status)
    solved = np.asarray(cold.status) == QPStatus.SOLVED
    np.testing.assert_allclose(np.asarray(warm.value)[solved], np.asarray(cold.value)[solved], atol=1e-5)


def test_a_start_has_no_gradient_and_needs_room(programs, solve):
    p = programs(2, 22)
    earlier = solve(p)

    def total(problem, earlier, value):
        return solve_qp(problem, start=eqx.tree_at(lambda s: s.value, earlier, value)).value.sum()

    by_start = batched(jax.grad(total, argnums=2), in_axes=(0, 0, 0), chunk=1)(p, earlier, earlier.value)
    np.testing.assert_array_equal(by_start, 0)
    one = jax.tree.map(lambda x: x[0], (p, earlier))
    with pytest.raises(ValueError, match="start: found together with fixed"):
        solve_qp(one[0], start=one[1], fixed=True)
