"""Small symmetric positive definite systems, written for many at once."""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float


class LDL(NamedTuple):
    """A = L D L' by columns: `lower[j]` is column j of L below the diagonal, `inverse[j]` is 1 / D_jj."""

    lower: list[Array]
    inverse: list[Array]


def weighted_gram(
    jacobian: Float[Array, "m n"], weight: Float[Array, "n"], ridge: Float[Array, "m"]
) -> list[Array]:
    """Columns, from the diagonal down, of J diag(w) J' + diag(ridge)."""
    weighted = jacobian * weight
    columns = [(weighted[j] * jacobian[j:]).sum(-1) for j in range(jacobian.shape[0])]
    return [jnp.concatenate([column[:1] + ridge[j], column[1:]]) for j, column in enumerate(columns)]


def factor(columns: list[Array]) -> LDL:
    """Factorises a matrix given by its columns from the diagonal down; no pivoting, no square roots."""
    lower, inverse, raw = [], [], []
    for j, column in enumerate(columns):
        for k in range(j):
            column = column - lower[k][j - k - 1] * raw[k][j - k :]
        pivot = 1 / jnp.maximum(column[0], jnp.finfo(column.dtype).tiny)
        raw.append(column)
        lower.append(column[1:] * pivot)
        inverse.append(pivot)
    return LDL(lower, inverse)


def solve(factors: LDL, right: Float[Array, "n"]) -> Float[Array, "n"]:
    """x of A x = right, with `n` the size of A."""
    size = len(factors.inverse)
    rest, forward = right, []
    for i in range(size):
        forward.append(rest[0])
        rest = rest[1:] - factors.lower[i] * rest[0]
    solved: list[Array] = []
    for i in reversed(range(size)):
        value = forward[i] * factors.inverse[i]
        if solved:
            value = value - (factors.lower[i] * jnp.stack(solved)).sum()
        solved.insert(0, value)
    return jnp.stack(solved)
