"""Factorisations of small matrices as plain elimination: LAPACK takes one world at a time, this takes all."""

from collections.abc import Callable

import jax
import jax.numpy as jnp
from jax.extend import core
from jaxtyping import Array, Float

# Larger matrices are left to the library: elimination is written out, so programs grow with the square.
_LARGEST = 16


def cholesky(A: Float[Array, "n n"]) -> Float[Array, "n n"]:
    """Lower L with L L' = A, from A's lower triangle; NaN where A is not positive definite."""
    n, columns, rest = A.shape[0], [], A
    for k in range(n):
        column = rest[:, 0] / jnp.sqrt(rest[0, 0])
        columns.append(jnp.concatenate([jnp.zeros(k, A.dtype), column]))
        if k + 1 < n:
            rest = rest[1:, 1:] - column[1:, None] * column[None, 1:]
    return jnp.stack(columns, axis=1)


def solve_triangular(
    A: Float[Array, "n n"],
    B: Float[Array, "n m"],
    *,
    left_side: bool,
    lower: bool,
    transpose_a: bool,
    unit_diagonal: bool,
) -> Float[Array, "n m"]:
    """X with op(A) X = B, or X op(A) = B from the right; A is triangular, op its transpose if asked for."""
    if not left_side:  # X op(A) = B is op(A)' X' = B'
        A, B, lower = (A, B.T, lower) if transpose_a else (A.T, B.T, not lower)
        return solve_triangular(
            A, B, left_side=True, lower=lower, transpose_a=False, unit_diagonal=unit_diagonal
        ).T
    A, lower = (A.T, not lower) if transpose_a else (A, lower)
    n = A.shape[0]
    order = range(n) if lower else range(n - 1, -1, -1)
    rows: list = [None] * n
    rest = B
    for k in order:
        row = rest[0] if lower else rest[-1]
        rows[k] = row if unit_diagonal else row / A[k, k]
        below = A[k + 1 :, k] if lower else A[:k, k]
        rest = (rest[1:] if lower else rest[:-1]) - below[:, None] * rows[k][None]
    return jnp.stack(rows)


def written_out(equation: core.JaxprEqn) -> core.ClosedJaxpr | None:
    """The operation of an equation as a plain one-world program, if it is one of these and small."""
    program = _program(equation)
    avals = [v.aval for v in equation.invars]
    if program is None or len(avals[0].shape) != 2 or max(avals[0].shape) > _LARGEST:  # type: ignore[attr-defined]
        return None
    return jax.make_jaxpr(program)(*avals)


def _program(equation: core.JaxprEqn) -> Callable | None:
    p = equation.params
    if equation.primitive.name == "cholesky":
        return cholesky
    if equation.primitive.name == "triangular_solve" and not p["conjugate_a"]:
        options = {k: p[k] for k in ("left_side", "lower", "transpose_a", "unit_diagonal")}
        return lambda A, B: solve_triangular(A, B, **options)
    return None
