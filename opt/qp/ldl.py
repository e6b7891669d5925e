"""Small symmetric positive definite systems, written for many at once."""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float


class LDL(NamedTuple):
    """A = L D L' by columns: `lower[j]` is column j of L below the diagonal, `inverse[j]` is 1 / D_jj."""

    lower: list[Array]
    inverse: list[Array]


def weighted_gram(rows: Float[Array, "m n"], weight: Float[Array, "n"]) -> list[Array]:
    """Columns, from the diagonal down, of G diag(w) G'."""
    weighted = rows * weight
    return [(weighted[j] * rows[j:]).sum(-1) for j in range(rows.shape[0])]


def factor(columns: list[Array], lift: Float[Array, "n"]) -> LDL:
    """Factorises the matrix given by its columns from the diagonal down, with `lift` added to its diagonal;
    no pivoting, no square roots.
    """
    lower, inverse, raw = [], [], []
    for j, column in enumerate(columns):
        for k in range(j):
            column = column - lower[k][j - k - 1] * raw[k][j - k :]
        pivot = 1 / jnp.maximum(column[0] + lift[j], jnp.finfo(column.dtype).tiny)
        raw.append(column)
        lower.append(column[1:] * pivot)
        inverse.append(pivot)
    return LDL(lower, inverse)


def solve_lower(factors: LDL, right: Float[Array, "n *r"]) -> Float[Array, "n *r"]:
    """Y of L Y = right: then right' A^-1 right = Y' D^-1 Y."""
    rest, rows = right, []
    for i in range(len(factors.inverse)):
        rows.append(rest[0])
        column = factors.lower[i] if right.ndim == 1 else factors.lower[i][:, None]
        rest = rest[1:] - column * rest[0]
    return jnp.stack(rows)


def solve(factors: LDL, right: Float[Array, "n"]) -> Float[Array, "n"]:
    """x of A x = right, with `n` the size of A."""
    return solve_upper(factors, solve_lower(factors, right)) if factors.inverse else right


def solve_upper(factors: LDL, right: Float[Array, "n"]) -> Float[Array, "n"]:
    """x of D L' x = right."""
    solved: list[Array] = []
    for i in reversed(range(len(factors.inverse))):
        value = right[i] * factors.inverse[i]
        for k, known in enumerate(solved):
            value = value - factors.lower[i][k] * known
        solved.insert(0, value)
    return jnp.stack(solved)
