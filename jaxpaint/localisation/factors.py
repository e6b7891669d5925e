"""Cholesky factors of 3 x 3 matrices and the two solves with them, written out so that they vectorise."""

import jax.numpy as jnp
from jaxtyping import Array, Float


def cholesky(A: Float[Array, "3 3"], least: float) -> Float[Array, "3 3"]:
    """The lower triangular C with A = C C^T, for a symmetric A whose eigenvalues are at least `least`.

    A pivot that rounding brought below `least` is lifted to it. A direction without any pivot (least = 0)
    gets a column of zeros, and gradients of zero.
    """
    zero = jnp.zeros_like(A[0, 0])
    C = [[zero] * 3 for _ in range(3)]
    for j in range(3):
        pivot = A[j, j]
        for k in range(j):
            pivot = pivot - C[j][k] * C[j][k]
        pivot = jnp.maximum(pivot, least)
        some = pivot > 0
        root = jnp.sqrt(jnp.where(some, pivot, 1))
        C[j][j] = jnp.where(some, root, 0)
        for i in range(j + 1, 3):
            left = A[i, j]
            for k in range(j):
                left = left - C[i][k] * C[j][k]
            C[i][j] = jnp.where(some, left / root, 0)
    return jnp.stack([jnp.stack(row) for row in C])


def forward_solve(C: Float[Array, "3 3"], B: Float[Array, "3 m"]) -> Float[Array, "3 m"]:
    """X with C X = B, for a lower triangular C without zeros on its diagonal."""
    x = B[0] / C[0, 0]
    y = (B[1] - C[1, 0] * x) / C[1, 1]
    return jnp.stack([x, y, (B[2] - C[2, 0] * x - C[2, 1] * y) / C[2, 2]])


def backward_solve(C: Float[Array, "3 3"], B: Float[Array, "3 m"]) -> Float[Array, "3 m"]:
    """X with C^T X = B, for a lower triangular C without zeros on its diagonal."""
    z = B[2] / C[2, 2]
    y = (B[1] - C[2, 1] * z) / C[1, 1]
    return jnp.stack([(B[0] - C[1, 0] * y - C[2, 0] * z) / C[0, 0], y, z])
