"""What training makes small: S1-(1), S1-(2) and their sum S1-(3), relative to the raw cloud's own."""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from nets.agn.blocks import BLOCK

_TINY = 1e-12
_NOWHERE = 1e6
_AT_ONCE = 32
"""Samples of the surface whose distances to the whole cloud are held at once."""


class LossWeights(eqx.Module):
    """Weights of the loss S1-(3); traced.

    chamfer_l2: of S1-(1). chamfer_l1: of the same with plain distances: without it a few far outliers are
    all that counts. smoothness: of S1-(2).
    """

    chamfer_l2: Float[Array, ""] = eqx.field(default=1.0, converter=jnp.asarray)
    chamfer_l1: Float[Array, ""] = eqx.field(default=1.0, converter=jnp.asarray)
    smoothness: Float[Array, ""] = eqx.field(default=0.02, converter=jnp.asarray)


class Distances(eqx.Module):
    """Two-way distances of a cloud P and a surface Q, as means: plain [m] and squared [m^2], P to Q and Q to
    P. The chamfer distances of S1 are the sums of both ways.
    """

    there: Float[Array, ""]
    back: Float[Array, ""]
    there_squared: Float[Array, ""]
    back_squared: Float[Array, ""]


def distances(
    cloud: Float[Array, "n 3"],
    valid: Bool[Array, " n"],
    nearest: Float[Array, "n 3"],
    truth: Float[Array, "q 3"],
    there: Bool[Array, " q"],
) -> Distances:
    """Of a cloud to a surface that is known exactly.

    nearest: of each point the nearest one of the surface, as if Q were sampled without end. truth: samples of
    what was seen of the surface, and which are real: for the way back.
    """
    count, seen = jnp.maximum(valid.sum(), 1), jnp.maximum(there.sum(), 1)
    to_surface = jnp.where(valid, _square(cloud - nearest), 0)
    to_cloud = jnp.where(there, _nearest_squares(truth, cloud, valid), 0)
    return Distances(
        there=_root(to_surface).sum() / count,
        back=_root(to_cloud).sum() / seen,
        there_squared=to_surface.sum() / count,
        back_squared=to_cloud.sum() / seen,
    )


def laplacian(cloud: Float[Array, "n 3"], valid: Bool[Array, " n"]) -> Float[Array, ""]:
    """S1-(2), as a mean: squared distance of each point from the mean of its K neighbours [m^2].

    The neighbours are the others of its block (K = 7): cloud in block order.
    """
    blocks, real = cloud.reshape(-1, BLOCK, 3), valid.reshape(-1, BLOCK, 1)
    total = jnp.where(real, blocks, 0).sum(1, keepdims=True)
    others = jnp.maximum(real.sum(1, keepdims=True) - 1, 1)
    apart = _square(blocks - (total - blocks) / others)
    counted = real[..., 0] & (real.sum(1) > 1)
    return jnp.where(counted, apart, 0).sum() / jnp.maximum(counted.sum(), 1)


def loss(
    weights: LossWeights, raw: Distances, refined: Distances, smoothness: Float[Array, ""]
) -> Float[Array, ""]:
    """S1-(3), a share of what the raw cloud has: scans from near and far then count alike.

    The squares' part is the root of S1-(1): as it stands one far outlier outweighs all the rest.
    """
    scale = raw.there_squared + _TINY
    squared = jnp.sqrt(
        (refined.there_squared + refined.back_squared) / (raw.there_squared + raw.back_squared + _TINY)
        + _TINY
    )
    plain = (refined.there + refined.back) / (raw.there + raw.back + _TINY)
    return weights.chamfer_l2 * squared + weights.chamfer_l1 * plain + weights.smoothness * smoothness / scale


def _nearest_squares(truth: Float[Array, "q 3"], cloud, valid) -> Float[Array, " q"]:
    """Squared distance of each sample to the cloud. The choice of the nearest point has no gradient, so that
    nothing of the size of both is kept for the way back.
    """
    fixed = jax.lax.stop_gradient(jnp.where(valid[:, None], cloud, _NOWHERE)).astype(jnp.float32)
    x, y, z = fixed.T
    numbers = jnp.arange(len(cloud), dtype=jnp.int32)
    mask = (1 << max(len(cloud) - 1, 1).bit_length()) - 1

    def choose(sample):
        dx, dy, dz = x - sample[0], y - sample[1], z - sample[2]
        # The bits of positive numbers are in their order, and the last ones hold the index: the least of
        # whole numbers is found ten times as fast as an index. Of distances that differ by a few thousandths
        # any is taken for the least.
        bits = jax.lax.bitcast_convert_type(dx * dx + dy * dy + dz * dz, jnp.int32)
        return jnp.min((bits & ~mask) | numbers) & mask

    chosen = jax.lax.map(choose, jax.lax.stop_gradient(truth).astype(jnp.float32), batch_size=_AT_ONCE)
    return _square(truth - cloud[chosen])


def _square(vectors: Float[Array, "*n 3"]) -> Float[Array, "*n"]:
    return (vectors * vectors).sum(-1)


def _root(squares: Float[Array, "*n"]) -> Float[Array, "*n"]:
    """Square roots with gradient zero at zero."""
    positive = squares > 0
    # where twice: the root of zero has no gradient, and NaN times zero is NaN
    return jnp.where(positive, jnp.sqrt(jnp.where(positive, squares, 1)), 0)
