"""Small symmetric positive definite systems, by elimination without pivoting.

LAPACK takes one world at a time; these few vector operations take all of them.
"""

import jax.numpy as jnp
from jaxtyping import Array, Float


def gram(J: Float[Array, "rows columns"]) -> Float[Array, "rows rows"]:
    """J J^T as a sum of outer products.

    A reduction would be evaluated again in every consumer (measured: three times slower in all).
    """
    total = J[:, None, 0] * J[None, :, 0]
    for k in range(1, J.shape[1]):
        total = total + J[:, None, k] * J[None, :, k]
    return total


def solve_spd(
    A: Float[Array, "n n"], B: Float[Array, "n m"]
) -> tuple[Float[Array, "n m"], Float[Array, " n"]]:
    """X with A X = B for a symmetric positive definite A, and the pivots, whose product is det A.

    Elimination needs no pivoting then. A pivot smaller than its own rounding error is lifted to it: for a
    singular A the result is finite, as are its gradients, but meaningless along A's null space; damp A where
    that matters.
    """
    n = A.shape[0]
    floor = n * jnp.finfo(A.dtype).eps * jnp.max(jnp.abs(A)) + jnp.finfo(A.dtype).tiny
    rest = jnp.concatenate([A, B], axis=1)
    rows, pivots = [], []
    for k in range(n):  # rest is what is left of [A | B], without the rows and columns that are done
        pivot = jnp.maximum(rest[0, 0], floor)
        row = rest[0, 1:] / pivot
        rows.append(row)
        pivots.append(pivot)
        if k + 1 < n:
            rest = rest[1:, 1:] - rest[1:, :1] * row[None]
    return jnp.stack(_substitute(rows, n)), jnp.stack(pivots)


def _substitute(rows, n: int):
    """Solves the unit upper triangular system whose row k is (entries right of the diagonal, right sides)."""
    solution: list = [None] * n
    for k in reversed(range(n)):
        ahead = n - 1 - k
        x = rows[k][ahead:]
        for j in range(ahead):
            x = x - rows[k][j] * solution[k + 1 + j]
        solution[k] = x
    return solution
