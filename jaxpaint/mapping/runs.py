"""Runs: the parts of the strokes that lie on the surface in one piece."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from jaxpaint.mapping.mapped import Cause, Mapped
from jaxpaint.mapping.medians import median_of
from jaxpaint.mapping.planes import norm, unit

_REACH = 24
"""Neighbours on either side that steady a normal."""


class Runs(eqx.Module):
    """Where each run lies in the list of points; a run is a stretch of neighbours.

    first, last: index of its ends. stroke: the stroke it is part of. colour: the tool that draws it. live:
    whether the slot holds a run.
    """

    first: Int[Array, "R"]
    last: Int[Array, "R"]
    stroke: Int[Array, "R"]
    colour: Int[Array, "R"]
    live: Bool[Array, "R"]


def linked(
    mapped: Mapped, stroke: Int[Array, "P"], jump: Float[Array, ""], turn: Float[Array, ""]
) -> Bool[Array, "P"]:
    """Whether each point continues the one before it on the surface.

    Both are hits of one stroke, no further apart than `jump` times the usual step [-], and their normals
    differ by no more than `turn` [rad].
    """
    hit = mapped.status == Cause.HIT
    pair = jnp.zeros_like(hit).at[1:].set(hit[1:] & hit[:-1] & (stroke[1:] == stroke[:-1]))
    step = steps(mapped.p_map)
    usual = median_of(step, pair)
    straight = jnp.sum(mapped.normal * jnp.roll(mapped.normal, 1, axis=0), axis=-1) >= jnp.cos(turn)
    return pair & (step <= jump * usual) & straight


def steps(p_map: Float[Array, "P 3"]) -> Float[Array, "P"]:
    """Distance of each point from the one before it [m]; zero, without gradient, for the first."""
    return jnp.pad(norm(p_map[1:] - p_map[:-1]), (1, 0))


def smooth_normals(mapped: Mapped, link: Bool[Array, "P"], length: Float[Array, ""]) -> Mapped:
    """Normals averaged along each run, so that the brush does not nod from point to point.

    A straight line is fitted to each coordinate of the normals about a point, weighted by exp(-s^2 / (2
    length^2)) over the distance s along the run [m]: unlike a mean it keeps a steady turn, up to the run's
    ends.
    """
    number = mapped.status.shape[0]
    index = jnp.arange(number)[:, None] + jnp.arange(-_REACH, _REACH + 1)
    inside, index = (index >= 0) & (index < number), jnp.clip(index, 0, number - 1)
    run = jnp.cumsum(~link)
    place = jnp.cumsum(jnp.where(link, steps(mapped.p_map), 0))
    ahead = (place[index] - place[:, None]) / length
    weight = jnp.exp(-jnp.square(ahead) / 2) * (inside & (run[index] == run[:, None]))
    total, first, second = (jnp.sum(weight * ahead**power, axis=1) for power in (0, 1, 2))
    second = second + 1e-3 * total  # a lone point keeps its normal
    share = weight * (second[:, None] - first[:, None] * ahead) / (total * second - first * first)[:, None]
    normal = jnp.sum(share[:, :, None] * mapped.normal[index], axis=1)
    return Mapped(mapped.p_map, unit(normal, otherwise=mapped.normal), mapped.status)


def find_runs(
    mapped: Mapped,
    stroke: Int[Array, "P"],
    link: Bool[Array, "P"],
    shortest: Float[Array, ""],
    most: int,
    colour: Int[Array, "strokes"] | None = None,
) -> tuple[Runs, Int[Array, "P"]]:
    """The runs in the points' order, and the points' status with what was left out.

    colour: of each stroke; all the first, if not given.

    A run shorter than `shortest` [m] is left out as SHORT if it is the rest of a stroke that was cut. A whole
    stroke that short is a dab, the brush pressed down and lifted, and stays; but without any length it takes
    no time and would not be painted: SHORT too. Runs beyond the `most` that there is room for are left out as
    OVERFLOW.
    """
    hit = mapped.status == Cause.HIT
    number = hit.shape[0]
    piece = jnp.cumsum(~link) - 1
    length = jnp.zeros(number, mapped.p_map.dtype).at[piece].add(jnp.where(link, steps(mapped.p_map), 0))
    whole = _whole(stroke, piece) & (length > 0)
    keep = hit & ((length >= shortest) | whole)[piece]
    begins = keep & ~link
    run = jnp.cumsum(begins) - 1
    fits = keep & (run < most)
    slot = jnp.where(fits, run, most)
    index = jnp.arange(number)
    first = jnp.full(most + 1, number - 1).at[slot].min(index)[:most]
    last = jnp.zeros(most + 1, index.dtype).at[slot].max(index)[:most]
    live = jnp.arange(most) < jnp.sum(begins)
    status = jnp.where(hit & ~keep, Cause.SHORT, jnp.where(keep & ~fits, Cause.OVERFLOW, mapped.status))
    first, last = jnp.where(live, first, 0), jnp.where(live, last, 0)
    of = jnp.where(live, stroke[first], -1)
    tool = (
        jnp.zeros_like(of) if colour is None else jnp.where(live, colour[stroke[first]], 0).astype(of.dtype)
    )
    return Runs(first, last, of, tool, live), status.astype(mapped.status.dtype)


def _whole(stroke: Int[Array, "P"], piece: Int[Array, "P"]) -> Bool[Array, "P"]:
    """Per piece of a stroke whether it holds the stroke's first point and its last."""
    border = stroke[1:] != stroke[:-1]
    none = jnp.zeros(stroke.shape, bool)
    first = none.at[piece].max(jnp.ones_like(none).at[1:].set(border))
    last = none.at[piece].max(jnp.ones_like(none).at[:-1].set(border))
    return first & last
