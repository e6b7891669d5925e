"""A robot's body for its controller: few spheres and rounded boxes, the gaps between them and how these
change.

One smooth gap stands for all pairs, so that one row of a program keeps all of them:

    gap = -t log sum_i exp(-gap_i / t) <= min_i gap_i,     d gap / dq = sum_i w_i d gap_i / dq

With the nearest pair alone, the others would be free to come near in the meantime.
"""

from typing import NamedTuple

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from jaxpaint.kinematics.chain import KinematicChain
from jaxpaint.kinematics.pose import Pose
from jaxpaint.kinematics.rotations import cross, rotate

# What counts as no distance at all: directions mean nothing there [m].
_TOUCHING = 1e-6
# Gap of what is not there [m].
_FAR = 1e3


class LinkSpheres(eqx.Module):
    """Spheres by the link that they ride on. center: in its frame [m]. radius [m]. count: how many each link
    of the chain has, in this order.
    """

    center: Float[Array, "s 3"]
    radius: Float[Array, "s"]
    count: tuple[int, ...] = eqx.field(static=True)

    def of(self, link: int) -> slice:
        """Which are a link's."""
        first = sum(self.count[:link])
        return slice(first, first + self.count[link])


class LinkBoxes(eqx.Module):
    """Boxes along the axes of the link that they ride on, rounded: all points within `radius` of a core.
    middle of the core, half its sides, in the link's frame [m]; a core without sides is a sphere's. count: as
    in `LinkSpheres`.
    """

    middle: Float[Array, "k 3"]
    half: Float[Array, "k 3"]
    radius: Float[Array, "k"]
    count: tuple[int, ...] = eqx.field(static=True)

    of = LinkSpheres.of


class BodyParts(eqx.Module):
    """What a controller must keep apart. outer: spheres of links nearer the tool. inner: rounded boxes of
    links nearer the base. pairs: links (outer, inner) of which spheres are held against boxes. ignored: true
    for a sphere and a box of a pair that do not count. skin: spheres that are held against the wall. Without
    pairs, as without skin, there is no such row.
    """

    outer: LinkSpheres
    inner: LinkBoxes
    ignored: tuple[Bool[Array, "s k"], ...]
    skin: LinkSpheres
    pairs: tuple[tuple[int, int], ...] = eqx.field(static=True)


class Gap(NamedTuple):
    """value: smooth least gap [m], never more than the true one of these parts. slope: d value / dq [m/rad,
    -]."""

    value: Float[Array, ""]
    slope: Float[Array, "joints"]


def own_gap_slope(chain: KinematicChain, parts: BodyParts, links: Pose, blend: Float[Array, ""]) -> Gap:
    """Between the parts of the robot. links: frames of the chain. blend: t [m].

    A pair moves only with the joints between its two links: joint j changes the gap by z_j . ((c - p_j) x n),
    with c the sphere's center and n the direction away from the box.
    """
    seen = [
        _pair(parts, links, *pair, ignored) for pair, ignored in zip(parts.pairs, parts.ignored, strict=True)
    ]
    value, weights = _blended([gap for gap, _, _ in seen], blend)
    force = {}
    for (outer, inner), weight, (_, away, place) in zip(parts.pairs, weights, seen, strict=True):
        push = (weight[..., None] * away).sum(1)
        f, m = push.sum(0), cross(place, push).sum(0)
        f, m = rotate(links.R[inner], f), rotate(links.R[inner], m)
        for j in range(inner + 1, outer + 1):  # moments about the inner link's origin
            force[j] = [*force.get(j, []), (f, m - cross(links.p[j] - links.p[inner], f))]
    slope = [_along(chain, links, j, force.get(j, [])) for j in range(chain.size)]
    return Gap(value, jnp.stack(slope))


def _pair(parts: BodyParts, links: Pose, outer: int, inner: int, ignored: Bool[Array, "s k"]):
    """Gaps [spheres, boxes], directions away from the boxes, and places of the spheres, in the inner link's
    frame.
    """
    spheres, boxes = parts.outer.of(outer), parts.inner.of(inner)
    center, R = parts.outer.center[spheres], links.R[outer]
    away = links.p[outer] - links.p[inner] + (R * center[:, None, :]).sum(-1)
    place = (links.R[inner] * away[:, :, None]).sum(1)
    off = place[:, None] - parts.inner.middle[boxes]
    half = parts.inner.half[boxes]
    off = off - jnp.clip(off, -half, half)
    distance = _length(off)
    gap = distance - parts.outer.radius[spheres][:, None] - parts.inner.radius[boxes]
    return jnp.where(ignored, _FAR, gap), off / distance[..., None], place


def plane_gap_slope(
    chain: KinematicChain,
    skin: LinkSpheres,
    links: Pose,
    point: Float[Array, "3"],
    axis: Float[Array, "3"],
    reach: Float[Array, ""],
    blend: Float[Array, ""],
) -> Gap:
    """Between the spheres and a plane through `point` that the unit vector `axis` points into, map frame.

    reach: a plane stands for a wall about one point of it; spheres further aside than this do not count [m].
    blend: t [m]. Joint j changes the gap of a sphere at c beyond it by -z_j . ((c - p_j) x axis).
    """
    having = [link for link in range(chain.size) if skin.count[link]]
    center = jnp.concatenate(
        [links.p[k] + (links.R[k] * skin.center[skin.of(k)][:, None, :]).sum(-1) for k in having]
    )
    off = point - center
    depth = (off * axis).sum(-1)
    aside = (off * off).sum(-1) - depth * depth > reach * reach
    value, (weight,) = _blended([jnp.where(aside, _FAR, depth - skin.radius)], blend)
    weight = jnp.where(aside, 0.0, weight)
    total, places = jnp.zeros_like(value), jnp.zeros_like(point)
    slope = [jnp.zeros_like(value)] * chain.size
    for j in reversed(range(chain.size)):  # what a joint carries: all spheres from it on
        if skin.count[j]:
            share, held = weight[skin.of(j)], center[skin.of(j)]
            total, places = total + share.sum(), places + (share[:, None] * held).sum(0)
        moment = cross(places - total * links.p[j], axis)
        slope[j] = -_along(chain, links, j, [(total * axis, moment)])
    return Gap(value, jnp.stack(slope))


def _blended(gaps: list[Array], blend: Float[Array, ""]) -> tuple[Array, list[Array]]:
    """The smooth minimum of all, and the weight of each in it."""
    least = jnp.stack([gap.min() for gap in gaps]).min()
    shares = [jnp.exp((least - gap) / blend) for gap in gaps]
    total = sum((share.sum() for share in shares), jnp.zeros_like(least))
    return least - blend * jnp.log(total), [share / total for share in shares]


def _along(chain: KinematicChain, links: Pose, joint: int, wrenches: list[tuple[Array, Array]]) -> Array:
    """What wrenches (force, moment about the joint) do along a joint's axis."""
    axis, hinge = links.R[joint][:, 2], chain.kinds[joint] == "hinge"
    parts = [(axis * (moment if hinge else force)).sum() for force, moment in wrenches]
    return sum(parts, jnp.zeros_like(axis[0]))


def _length(vectors: Float[Array, "*s 3"]) -> Float[Array, "*s"]:
    square = (vectors * vectors).sum(-1)
    apart = square > _TOUCHING**2
    return jnp.where(apart, jnp.sqrt(jnp.where(apart, square, 1.0)), _TOUCHING)


def no_parts(chain: KinematicChain) -> BodyParts:
    """A body that nothing is known of: its controller has no clearance rows."""
    none, row = (0,) * chain.size, np.zeros((0, 3), np.float32)
    spheres = LinkSpheres(jnp.asarray(row), jnp.asarray(row[:, 0]), none)
    boxes = LinkBoxes(jnp.asarray(row), jnp.asarray(row), jnp.asarray(row[:, 0]), none)
    return BodyParts(spheres, boxes, (), spheres, ())
