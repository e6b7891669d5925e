"""How close a measured cloud is to the true surface: chamfer distances."""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from sims.scenes.charts import AbstractChart

# Points of the cloud at once: what a cache holds of their distances to all samples.
_BLOCK = 128


class Chamfer(eqx.Module):
    """Two-way distances between point sets: l1 [m] (half of the sum of both means), l2 [m^2] (S1-(1))."""

    l1: Float[Array, ""]
    l2: Float[Array, ""]


def chamfer(
    cloud: Float[Array, "points 3"], valid: Bool[Array, "points"], truth: Float[Array, "samples 3"]
) -> Chamfer:
    """Chamfer distances between the valid points of a cloud P and a sampled surface Q.

    l2 is S1-(1): mean over P of the squared distance to the nearest of Q, plus the same from Q to P. l1 takes
    plain distances and halves the sum, as PCN does. Without valid points both are infinite. Blockwise: no
    array of points x samples is ever made.
    """
    to_truth, to_cloud = _nearest_squares(cloud, valid, truth)
    count = valid.sum(dtype=to_truth.dtype)
    there = jnp.where(valid, to_truth, 0)
    some = count > 0
    count = jnp.where(some, count, 1)
    l2 = there.sum() / count + to_cloud.mean()
    l1 = 0.5 * (_root(there).sum() / count + _root(to_cloud).mean())
    return Chamfer(l1=jnp.where(some, l1, jnp.inf), l2=jnp.where(some, l2, jnp.inf))


def surface_samples(
    chart: AbstractChart, lower: Float[Array, "2"], upper: Float[Array, "2"], *, columns: int, rows: int
) -> Float[Array, "samples 3"]:
    """Points of the true surface on an even (u, v) grid over a rectangle [m], rows x columns of them."""
    u = lower[0] + (upper[0] - lower[0]) * (jnp.arange(columns) + 0.5) / columns
    v = lower[1] + (upper[1] - lower[1]) * (jnp.arange(rows) + 0.5) / rows
    uv = jnp.stack(jnp.meshgrid(u, v), axis=-1).reshape(-1, 2)
    return jax.vmap(chart.point)(uv)


def _nearest_squares(cloud, valid, truth):
    """Squared distance from each cloud point to the truth and from each truth point to the cloud [m^2].

    Differences first, squares then: the expanded form p^2 - 2 p q + q^2 loses millimetres in float32.
    """
    size = -(-len(cloud) // _BLOCK) * _BLOCK
    missing = size - len(cloud)
    blocks = jnp.pad(cloud, ((0, missing), (0, 0))).reshape(-1, _BLOCK, 3)
    there = jnp.pad(valid, (0, missing)).reshape(-1, _BLOCK)

    def visit(best, block):
        points, real = block
        dx, dy, dz = (points[:, None, axis] - truth[None, :, axis] for axis in range(3))
        squares = dx * dx + dy * dy + dz * dz
        nearest = jnp.where(real[:, None], squares, jnp.inf).min(0)
        return jnp.minimum(best, nearest), squares.min(1)

    start = jnp.full(len(truth), jnp.inf, cloud.dtype)
    to_cloud, to_truth = jax.lax.scan(jax.checkpoint(visit), start, (blocks, there))
    return to_truth.reshape(-1)[: len(cloud)], to_cloud


def _root(squares: Float[Array, "n"]) -> Float[Array, "n"]:
    """Square root with gradient 0 at 0 (double where), where points coincide."""
    positive = squares > 0
    return jnp.where(positive, jnp.sqrt(jnp.where(positive, squares, 1)), 0)
