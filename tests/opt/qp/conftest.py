"""Random programs of the shape that a controller solves."""

from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.compiling import Batched, batched
from opt.qp import QPSolution, QuadraticProgram, solve_qp


def draw(count: int, seed: int, dtype=np.float32, compliance=0.0, rows=0, dense=False) -> QuadraticProgram:
    """Programs with a point inside all bounds and inequality rows that meets the task rows."""
    rng, n, m = np.random.default_rng(seed), 9, 6
    lower, upper = -rng.uniform(0.15, 1.0, (count, n)), rng.uniform(0.15, 1.0, (count, n))
    inside = rng.uniform(0.7 * lower, 0.7 * upper)
    J = rng.normal(size=(count, m, n)) * np.r_[np.ones(3), np.full(6, 0.5)]
    A = rng.normal(size=(count, rows, n))
    hessian = 0.01 * rng.uniform(0.5, 2.0, (count, n))
    if dense:
        factor = rng.normal(size=(count, n, n))
        hessian = 0.01 * (factor @ factor.transpose(0, 2, 1) / n + 0.2 * np.eye(n))
    arrays = (
        hessian,
        rng.normal(size=(count, n)) * 0.02,
        J,
        (J @ inside[..., None])[..., 0],
        np.full((count, m), compliance),
        A,
        (A @ inside[..., None])[..., 0] + rng.uniform(0.01, 0.3, (count, rows)),
        lower,
        upper,
    )
    return QuadraticProgram(*(jnp.asarray(a, dtype) for a in arrays))


@pytest.fixture(scope="session")
def programs() -> Callable[..., QuadraticProgram]:
    return draw


@pytest.fixture(scope="session")
def solve() -> Batched:
    """`solve_qp` of many programs."""
    return batched(lambda problem: solve_qp(problem), in_axes=(0,), chunk=32)


def answered(problem: QuadraticProgram):
    """`solve_qp` of one program, compiled as all are: XLA as it ships takes minutes over this code."""
    return jax.tree.map(lambda x: x[0], SOLVE(jax.tree.map(lambda x: x[None], problem)))


SOLVE = batched(lambda problem: solve_qp(problem), in_axes=(0,), chunk=1)


@pytest.fixture(scope="session")
def answer() -> Callable[[QuadraticProgram], QPSolution]:
    return answered
