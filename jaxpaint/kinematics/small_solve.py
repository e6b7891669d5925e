"""Small symmetric positive definite systems, by elimination without pivoting.

LAPACK takes one world at a time; these few vector operations take all of them.
"""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float


def product(A: Float[Array, "n k"], B: Float[Array, "k m"]) -> Float[Array, "n m"]:
    """A B as a sum of outer products.

    A reduction would be evaluated again in every consumer (measured: three times slower in all).
    """
    total = A[:, :1] * B[:1]
    for k in range(1, A.shape[1]):
        total = total + A[:, k : k + 1] * B[k : k + 1]
    return total


def gram(J: Float[Array, "rows columns"]) -> Float[Array, "rows rows"]:
    """J J^T."""
    return product(J, J.T)


@jax.custom_jvp
def inverse_spd(A: Float[Array, "n n"]) -> tuple[Float[Array, "n n"], Float[Array, ""]]:
    """A^-1 and the root of det A, of a symmetric positive definite A; see `solve_spd`.

    Its derivatives are products of the inverse, fewer than an elimination's own.
    """
    inverse, pivots = solve_spd(A, jnp.eye(A.shape[0], dtype=A.dtype))
    # The root of each: their product would underflow where A is nearly singular.
    return inverse, jnp.prod(jnp.sqrt(pivots))


@inverse_spd.defjvp
def _(primals, tangents):
    inverse, root = inverse_spd(*primals)
    (change,) = tangents
    return (inverse, root), (-product(product(inverse, change), inverse), root / 2 * (inverse * change).sum())


def solve_spd(
    A: Float[Array, "n n"], B: Float[Array, "n m"]
) -> tuple[Float[Array, "n m"], Float[Array, " n"]]:
    """X with A X = B for a symmetric positive definite A, and the pivots, whose product is det A.

    Elimination needs no pivoting then. A pivot smaller than its own rounding error is lifted to it: for a
    singular A the result is finite, as are its gradients, but meaningless along A's null space; damp A where
    that matters.
    """
    n = A.shape[0]
    # No entry is larger than the diagonal's largest.
    floor = n * jnp.finfo(A.dtype).eps * jnp.diagonal(A).max() + jnp.finfo(A.dtype).tiny
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
