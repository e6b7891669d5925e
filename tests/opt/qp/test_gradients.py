"""Implicit gradients against central differences, and forward against reverse, in float64."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.compiling import batched
from opt.qp import QPStatus, quadratic_program, solve_qp

COUNT, STEP = 20, 1e-5
WEIGHT = np.random.default_rng(2).normal(size=9)


def objective(problem, smoothing):
    solution = solve_qp(problem, smoothing=smoothing, iterations=30, fixed=True)
    return (jnp.asarray(WEIGHT) * solution.value).sum(), solution


def symmetric(tangent):
    """A change of M that keeps it symmetric."""
    matrix = tangent.hessian
    return tangent if matrix.ndim == 2 else eqx.tree_at(lambda t: t.hessian, tangent, matrix + matrix.mT)


def directions(programs, name, seed):
    """A random change of one input, in all programs."""
    rng = np.random.default_rng(seed)
    zero = jax.tree.map(jnp.zeros_like, programs)
    leaf = getattr(programs, name)
    scale = np.maximum(np.abs(np.asarray(leaf)), 1e-3)
    return symmetric(
        eqx.tree_at(lambda q: getattr(q, name), zero, jnp.asarray(scale * rng.normal(size=leaf.shape)))
    )


def moved(programs, tangent, step):
    return jax.tree.map(lambda x, t: x + step * t, programs, tangent)


def settled(programs, solution, smoothing):
    """Which programs keep their active bounds within the difference step: all where the path is smooth."""
    keep = np.asarray(solution.status) == QPStatus.SOLVED
    if smoothing:
        return keep
    x, dual = solution.value, solution.dual
    pairs = (
        (programs.upper - x, dual.upper),
        (x - programs.lower, dual.lower),
        (programs.limit - (programs.rows @ x[..., None])[..., 0], dual.rows),
    )
    for gap, multiplier in pairs:
        keep &= np.asarray(jnp.maximum(gap, multiplier).min(axis=1, initial=1.0) > 1e-3)
    return keep


@pytest.mark.parametrize(
    ("smoothing", "dense", "rows", "compliance"),
    [(0.0, False, 0, 0.0), (1e-6, True, 3, 0.0), (1e-3, False, 0, 1e-3)],
)
def test_agree_with_differences_and_forward_with_reverse(x64, programs, smoothing, dense, rows, compliance):
    p = programs(COUNT, 1, dtype=np.float64, dense=dense, rows=rows, compliance=compliance)

    def of(problem):
        return objective(problem, smoothing)

    value = batched(of, in_axes=(0,), chunk=COUNT)
    reverse = batched(jax.grad(of, has_aux=True), in_axes=(0,), chunk=COUNT)
    forward = batched(lambda q, t: jax.jvp(lambda q: of(q)[0], (q,), (t,))[1], in_axes=(0, 0), chunk=COUNT)
    gradient, solution = reverse(p)
    keep = settled(p, solution, smoothing)
    assert keep.sum() >= COUNT // 3
    names = ["hessian", "linear", "jacobian", "target", "rows", "limit", "lower", "upper"]
    names += ["compliance"] if compliance else []
    for seed, name in enumerate(n for n in names if getattr(p, n).size):
        t = directions(p, name, seed)
        ahead, behind = value(moved(p, t, STEP))[0], value(moved(p, t, -STEP))[0]
        difference = np.asarray(ahead - behind) / (2 * STEP)
        along = forward(p, t)
        back = total(getattr(gradient, name) * getattr(t, name))
        size = np.sqrt(total(getattr(gradient, name) ** 2) * total(getattr(t, name) ** 2))
        np.testing.assert_array_less(np.abs(along - back), 1e-9 * np.maximum(size, 1), err_msg=name)
        np.testing.assert_array_less(np.abs(back - difference)[keep], 1e-5 * size[keep] + 1e-9, err_msg=name)


def total(x):
    return np.asarray(x).reshape(COUNT, -1).sum(1)


def test_smoothing_carries_over_a_change_of_the_active_set(x64):
    """x = clip(t, -1, 1) as t passes 1: at the kink the derivative is that of the smoothed problem."""

    def x_of(t):
        program = quadratic_program(jnp.ones(1), -t[None], lower=-1.0, upper=1.0)
        return solve_qp(program, smoothing=1e-3, iterations=30, fixed=True).value[0]

    at = jnp.linspace(0.9, 1.1, 21)
    slope = batched(jax.grad(x_of), in_axes=(0,), chunk=21)(at)
    run = batched(x_of, in_axes=(0,), chunk=21)
    np.testing.assert_allclose(slope, (run(at + STEP) - run(at - STEP)) / (2 * STEP), rtol=1e-6)
    assert (np.diff(slope) < 0).all()
    assert slope[0] > 0.85
    assert slope[-1] < 0.15
