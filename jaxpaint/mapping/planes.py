"""The plane through a patch of noisy points that may hold other surfaces too.

Points come as rows x, y, z: sums over them are several times faster so.
"""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

_ROUNDS = 4
"""Power iterations: each gains the ratio of the two smaller variances."""


def weighted_plane(
    points: Float[Array, "3 K"], weight: Float[Array, "K"], guess: Float[Array, "3"]
) -> tuple[Float[Array, "3"], Float[Array, "3"]]:
    """Centre and unit normal of the plane that fits best: PCA's axis of least variance.

    Power iteration on the adjugate of the covariance, whose largest eigenvector is that axis: only products
    and sums, no eigenvalue to divide by, so gradients stay finite. guess: unit, not along the plane;
    the normal comes out on its side. Points that determine no plane give some finite normal.
    """
    total = jnp.sum(weight)
    share = weight / jnp.where(total > 0, total, 1)
    centre = weighted_mean(points, share)
    x, y, z = points[0] - centre[0], points[1] - centre[1], points[2] - centre[2]
    xx, xy, xz = jnp.sum(share * x * x), jnp.sum(share * x * y), jnp.sum(share * x * z)
    yy, yz, zz = jnp.sum(share * y * y), jnp.sum(share * y * z), jnp.sum(share * z * z)
    rows = (
        jnp.stack([yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy]),
        jnp.stack([xz * yz - xy * zz, xx * zz - xz * xz, xy * xz - xx * yz]),
        jnp.stack([xy * yz - xz * yy, xy * xz - xx * yz, xx * yy - xy * xy]),
    )
    trace = rows[0][0] + rows[1][1] + rows[2][2]
    adjugate = jnp.stack(rows) / jnp.where(trace > 0, trace, 1)
    normal = jax.lax.fori_loop(
        0, _ROUNDS, lambda _, normal: unit(jnp.sum(adjugate * normal, axis=1), otherwise=guess), guess
    )
    return centre, jnp.where(jnp.sum(normal * guess) < 0, -normal, normal)


def weighted_mean(points: Float[Array, "3 K"], share: Float[Array, "K"]) -> Float[Array, "3"]:
    """Sum of the points times their shares."""
    return jnp.stack([jnp.sum(share * row) for row in points])


def along(points: Float[Array, "3 K"], direction: Float[Array, "3"]) -> Float[Array, "K"]:
    """Coordinate of the points along a direction."""
    return points[0] * direction[0] + points[1] * direction[1] + points[2] * direction[2]


def squared(points: Float[Array, "3 K"]) -> Float[Array, "K"]:
    """Squared distance of the points from the origin."""
    return points[0] * points[0] + points[1] * points[1] + points[2] * points[2]


def bisquare(ratio_squared: Float[Array, "*n"]) -> Float[Array, "*n"]:
    """Tukey's weight (1 - r^2)^2 of the squared ratio r^2, zero from r = 1 on."""
    return jnp.square(jnp.maximum(1 - ratio_squared, 0))


def norm(vector: Float[Array, "*n 3"]) -> Float[Array, "*n"]:
    """Length of vectors, with gradient zero where it is zero."""
    square = jnp.sum(vector * vector, axis=-1)
    fine = square > 0
    # where twice: the root of zero has no gradient, and NaN times zero is NaN
    return jnp.where(fine, jnp.sqrt(jnp.where(fine, square, 1)), 0)


def unit(vector: Float[Array, "*n 3"], otherwise: Float[Array, "#*n 3"]) -> Float[Array, "*n 3"]:
    """Vectors at length one; `otherwise` where there is no length."""
    length = norm(vector)[..., None]
    fine = length > 0
    return jnp.where(fine, vector / jnp.where(fine, length, 1), otherwise)
