"""Clouds of any size: overlapping patches of one size, whose residuals are blended."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from jaxpaint.mapping.planes import norm
from nets.agn.anchors import Patch
from nets.agn.blocks import BLOCK, GROUP, block_order, padded_size
from nets.agn.network import AGN

PATCH = 16_384
"""Points of a patch, those that the network was trained with."""
_RUN = BLOCK * GROUP
"""Points that go into a patch together."""
_NOWHERE = 1e9


def refine(
    network: AGN,
    points: Float[Array, "n 3"],
    valid: Bool[Array, " n"] | None = None,
    ray: Float[Array, "n 3"] | None = None,
    colour: Float[Array, "n 3"] | None = None,
    *,
    patch: int = PATCH,
) -> Float[Array, "n 3"]:
    """The cloud with its residuals added, S' = S + residual (S1 section III-A); the rest stays as it is.

    points: any unit, any order, any number. ray: unit, from the camera to each point; colour: 0 to 1; None
    where not known. patch: points of a patch, a power of two. Half of a patch is its core, and cores share
    out the cloud; the other half are the points about the core, which count less the further off they are.
    """
    size = padded_size(len(points), patch)
    whole = _padded(points, valid, ray, colour, size)
    order = block_order(whole.points, whole.valid)
    whole = jax.tree.map(lambda leaf: leaf[order] if leaf.ndim else leaf, whole)
    middle = _mean(whole.points, whole.valid)
    whole = _placed(whole, whole.points - middle)
    moved = network(whole) if size == patch else _blended(network, whole, patch)
    back = jnp.zeros_like(moved).at[order].set(moved, unique_indices=True)
    return points + back[: len(points)]


def _padded(points, valid, ray, colour, size: int) -> Patch:
    more = size - len(points)

    def pad(rows, like):
        rows = jnp.zeros_like(like) if rows is None else rows
        return jnp.concatenate([rows, jnp.zeros((more, *rows.shape[1:]), rows.dtype)])

    there = jnp.ones(len(points), bool) if valid is None else valid
    there = pad(there & jnp.isfinite(points).all(-1), there)
    # What is no number must not reach a sum, not even times zero.
    return Patch(
        points=jnp.where(there[:, None], pad(points, points), 0),
        valid=there,
        ray=jnp.where(there[:, None], pad(ray, points), 0),
        colour=jnp.where(there[:, None], pad(colour, points), 0),
        coloured=jnp.asarray(colour is not None),
    )


def _blended(network: AGN, whole: Patch, patch: int) -> Float[Array, "n 3"]:
    """Residuals of a cloud in block order by patches of its runs."""
    runs = jax.tree.map(lambda leaf: leaf.reshape(-1, _RUN, *leaf.shape[1:]) if leaf.ndim else leaf, whole)
    real = runs.valid[..., None]
    lower = jnp.where(real, runs.points, _NOWHERE).min(1)
    upper = jnp.where(real, runs.points, -_NOWHERE).max(1)
    own = patch // _RUN // 2

    def visit(core: Int[Array, ""]):
        mine = own * core + jnp.arange(own)
        low, high = lower[mine].min(0), upper[mine].max(0)
        gap = norm(jnp.maximum(jnp.maximum(low - upper, lower - high), 0))
        gap = jnp.where(runs.valid.any(1), gap, _NOWHERE).at[mine].set(_NOWHERE)
        nearest, around = jax.lax.top_k(-gap, own)
        far = jnp.max(jnp.where(-nearest < _NOWHERE, -nearest, 0))
        taken = jnp.concatenate([mine, around])
        weight = jnp.concatenate([jnp.ones(own), jnp.where(-nearest < _NOWHERE, 1.0, 0.0)])
        part = jax.tree.map(lambda leaf: leaf[taken].reshape(patch, -1) if leaf.ndim else leaf, runs)
        part = _placed(part, part.points - _mean(part.points, part.valid[:, 0]), part.valid[:, 0])
        apart = norm(jnp.maximum(jnp.maximum(low - part.points, part.points - high), 0))
        share = jnp.square(jnp.maximum(1 - apart / jnp.maximum(far, _tiny(far)), 0))
        share = jnp.where(jnp.arange(patch) < patch // 2, 1, share) * jnp.repeat(weight, _RUN)
        return taken, network(part), share

    def nothing(core: Int[Array, ""]):
        return own * core + jnp.arange(2 * own), jnp.zeros((patch, 3)), jnp.zeros(patch)

    def either(core: Int[Array, ""]):
        return jax.lax.cond(runs.valid[own * core].any(), visit, nothing, core)

    taken, moved, share = jax.lax.map(either, jnp.arange(len(lower) // own))
    share = share.reshape(-1, _RUN)
    index = taken.reshape(-1)
    total = jnp.zeros(runs.valid.shape).at[index].add(share)
    added = jnp.zeros(runs.points.shape).at[index].add(share[..., None] * moved.reshape(-1, _RUN, 3))
    return (added / jnp.where(total > 0, total, 1)[..., None]).reshape(-1, 3)


def _placed(patch: Patch, points, valid=None) -> Patch:
    """The patch with its points elsewhere; what is not valid at the origin."""
    valid = patch.valid if valid is None else valid
    return Patch(jnp.where(valid[:, None], points, 0), valid, patch.ray, patch.colour, patch.coloured)


def _mean(points: Float[Array, "n 3"], valid: Bool[Array, " n"]) -> Float[Array, "3"]:
    return jnp.where(valid[:, None], points, 0).sum(0) / jnp.maximum(valid.sum(), 1)


def _tiny(like: Array) -> float:
    return float(jnp.finfo(like.dtype).tiny)
