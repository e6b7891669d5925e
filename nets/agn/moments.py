"""Centre and covariance of weighted points, and of sets of sets: what a plane is fitted to."""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from jaxpaint.mapping.planes import unit

_ROUNDS = 6
"""Power iterations."""
_TINY = 1e-9
"""Share of the whole variance that keeps 0 / 0 out where points coincide."""
_THIN = 1e-5
"""Product of the two larger shares of the variance below which points lie in a line: more than it rounds."""
_ASIDE = 1e-3
"""Weight of a second matrix of the same eigenvectors, which lines do not make zero."""


class Moments(eqx.Module):
    """Mean and covariance of a set of points, with total weight one; any axes before."""

    centre: Float[Array, "*sets 3"]
    covariance: Float[Array, "*sets 3 3"]

    def __getitem__(self, index: Int[Array, "*sets k"]) -> "Moments":
        return Moments(self.centre[index], self.covariance[index])


def of_points(weight: Float[Array, "sets k"], points: Float[Array, "sets k 3"]) -> Moments:
    """Of points with weights that sum to one."""
    centre = (weight[..., None] * points).sum(1)
    apart = points - centre[:, None]
    return Moments(centre, _spread(weight, apart))


def of_sets(weight: Float[Array, "sets k"], parts: Moments) -> Moments:
    """Of the union of k sets each, with weights that sum to one: as if all their points had been taken."""
    centre = (weight[..., None] * parts.centre).sum(1)
    within = (weight[..., None, None] * parts.covariance).sum(1)
    return Moments(centre, within + _spread(weight, parts.centre - centre[:, None]))


def normal_of(moments: Moments, guess: Float[Array, "*sets 3"]) -> Float[Array, "*sets 3"]:
    """Unit normal of the plane of least squares, on the side of `guess` (unit, not along the plane).

    Power iteration on the adjugate of the covariance, as `jaxpaint.mapping.planes.weighted_plane`: gradients
    stay finite. Points in a line give a normal across it, and those in one place the guess.
    """
    whole = jnp.trace(moments.covariance, axis1=-2, axis2=-1)[..., None, None]
    C = moments.covariance / (whole + _TINY)
    xx, yy, zz = C[..., 0, 0], C[..., 1, 1], C[..., 2, 2]
    xy, xz, yz = C[..., 0, 1], C[..., 0, 2], C[..., 1, 2]
    rows = (
        jnp.stack([yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy], axis=-1),
        jnp.stack([xz * yz - xy * zz, xx * zz - xz * xz, xy * xz - xx * yz], axis=-1),
        jnp.stack([xy * yz - xz * yy, xy * xz - xx * yz, xx * yy - xy * xy], axis=-1),
    )
    trace = rows[0][..., 0] + rows[1][..., 1] + rows[2][..., 2]
    adjugate = jnp.stack(rows, axis=-2) / (trace + _THIN)[..., None, None]
    across = jnp.trace(C, axis1=-2, axis2=-1)[..., None, None] * jnp.eye(3, dtype=C.dtype) - C
    matrix = adjugate + _ASIDE * across

    def again(_, normal):
        return unit(dot(matrix, normal[..., None, :]), otherwise=guess)

    normal = jax.lax.fori_loop(0, _ROUNDS, again, guess)
    return jnp.where((dot(normal, guess) < 0)[..., None], -normal, normal)


def across(moments: Moments, normal: Float[Array, "*sets 3"]) -> Float[Array, "*sets"]:
    """Variance along the normal."""
    return dot(normal, dot(moments.covariance, normal[..., None, :]))


def dot(a: Float[Array, "*n 3"], b: Float[Array, "*n 3"]) -> Float[Array, "*n"]:
    """Scalar products, written out: XLA's sums over three numbers at the end of a row are slow on CPUs."""
    return a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1] + a[..., 2] * b[..., 2]


def _spread(weight: Float[Array, "sets k"], apart: Float[Array, "sets k 3"]) -> Float[Array, "sets 3 3"]:
    return jnp.einsum("sk,ska,skb->sab", weight, apart, apart)
