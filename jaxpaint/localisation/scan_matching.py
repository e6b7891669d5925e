"""A planar scan against the pieces of a map, point to line or arc."""

from typing import NamedTuple

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from jaxpaint.localisation.evidence import Evidence, evidence_of, lever
from jaxpaint.localisation.outline import Outline
from jaxpaint.localisation.robust import inlier_shares


class ScanSettings(eqx.Module):
    """Numbers of the matching; all traced.

    range_sigma: standard deviation of a range [m]. surface_sigma: how far a wall is from its piece
    [m]. margin: an echo may lie this far beyond a piece's end [m]. gate: distance from a piece beyond which
    an echo is of something else [m]. robust: distance at which an echo counts a quarter [m], 3 standard
    deviations. looks: this many looks share what a piece itself is wrong by: their average is no better
    than the map, and a filter that takes each for a new measurement must be told.
    """

    range_sigma: Float[Array, ""] = eqx.field(default=0.01, converter=jnp.asarray)
    surface_sigma: Float[Array, ""] = eqx.field(default=0.002, converter=jnp.asarray)
    margin: Float[Array, ""] = eqx.field(default=0.03, converter=jnp.asarray)
    gate: Float[Array, ""] = eqx.field(default=0.15, converter=jnp.asarray)
    robust: Float[Array, ""] = eqx.field(default=0.03, converter=jnp.asarray)
    looks: Float[Array, ""] = eqx.field(default=1.0, converter=jnp.asarray)


def match_scan(
    outline: Outline,
    pose: Float[Array, "3"],
    T_base_lidar: Float[Array, "3"],
    ranges: Float[Array, "b"],
    valid: Bool[Array, "b"],
    bearings: Float[Array, "b"],
    settings: ScanSettings | None = None,
) -> Evidence:
    """What a scan says about the error of the pose (x, y [m], yaw [rad]) that the base is believed to have.

    T_base_lidar: (x, y, yaw) of the scanner in the base frame. ranges [m] along bearings in the scanner's
    frame [rad]; one that is not valid or not finite counts nothing. Each echo goes to the nearest live piece
    that the scanner is in front of and whose extent holds its foot: e is its distance from the line,
    J = [n_x, n_y, n . perp(p - base)]. m echoes of a piece share what it is wrong by, and weigh
    m / (variance of one + m sigma_piece^2) together. An empty sum where nothing matches.

    About 29 operations for each pair of echo and piece and 170 for each echo, all dense: 99,000 for 90 beams
    and 32 pieces, 31,000 for 60 and 12.
    """
    s = settings or ScanSettings()
    seen = valid & jnp.isfinite(ranges)
    origin, direction = _beams(pose, T_base_lidar, bearings)
    points = origin[None] + jnp.where(seen, ranges, 0)[:, None] * direction
    near = _nearest_pieces(outline, points, seen, origin, s)
    normal, residual = _off_surface(near, points)
    rows = lever(normal, points, pose[:2])
    squarely = (normal * direction).sum(-1)
    variance = s.range_sigma**2 * squarely**2 + s.surface_sigma**2 + s.looks * near.shared
    precision = near.found / variance
    share = inlier_shares(rows, residual, precision, s.robust, s.gate)
    return evidence_of(rows, residual, precision, share)


def _beams(pose, T_base_lidar, bearings):
    """Where the scanner stands in the map, and where its beams go."""
    c, s = jnp.cos(pose[2]), jnp.sin(pose[2])
    x, y, yaw = T_base_lidar[0], T_base_lidar[1], T_base_lidar[2]
    origin = pose[:2] + jnp.stack([c * x - s * y, s * x + c * y])
    heading = pose[2] + yaw + bearings
    return origin, jnp.stack([jnp.cos(heading), jnp.sin(heading)], axis=-1)


class _Near(NamedTuple):
    """Of each echo's piece: the normal at its middle, where the middle is along that (`place`) and to the
    left of it (`aside`), the curvature, and its variance times its echoes. found: 1, or 0 where none is near.
    """

    normal: Float[Array, "b 2"]
    place: Float[Array, "b"]
    aside: Float[Array, "b"]
    curvature: Float[Array, "b"]
    shared: Float[Array, "b"]
    found: Float[Array, "b"]


def _nearest_pieces(outline: Outline, points, seen, origin, s: ScanSettings) -> _Near:
    """Picked by dense sums with a mask and no gather: few pieces, and the same for all worlds."""
    n = outline.normal
    ends = [e[:, 1] * n[:, 0] - e[:, 0] * n[:, 1] for e in (outline.start, outline.end)]
    first, last = jnp.minimum(*ends), jnp.maximum(*ends)
    depth = _depth(outline.curvature, (last - first) / 2)
    place = (outline.start * n).sum(-1) + depth
    x, y = points[:, :1], points[:, 1:]
    across = x * n[None, :, 0] + y * n[None, :, 1] - place[None]
    along = y * n[None, :, 0] - x * n[None, :, 1]
    usable = (outline.live > 0) & ((n * origin[None]).sum(-1) > place)  # seen from before it
    low, high = jnp.where(usable, first - s.margin, jnp.inf), last + s.margin
    fits = (along > low[None]) & (along < high[None])
    distance = jnp.where(fits, jnp.abs(across), jnp.inf)
    nearest = distance.min(axis=1)
    found = (nearest < s.gate) & seen
    picked = (distance == jnp.where(found, nearest, -1)[:, None]).astype(points.dtype)
    share = 1 / jnp.maximum(picked.sum(axis=1), 1)  # two pieces may be equally near
    shared = outline.sigma**2 * picked.sum(axis=0)

    def mine(column):
        return (picked * column[None]).sum(1) * share

    return _Near(
        normal=jnp.stack([mine(n[:, 0]), mine(n[:, 1])], axis=-1),
        place=mine(place),
        aside=mine((first + last) / 2),
        curvature=mine(outline.curvature),
        shared=mine(shared),
        found=found.astype(points.dtype),
    )


def _depth(curvature, half):
    """How far the middle of an arc stands out from its ends, towards the normal."""
    bent = jnp.minimum((curvature * half) ** 2, 0.99)
    return curvature * half**2 / (1 + jnp.sqrt(1 - bent))


def _off_surface(near: _Near, points):
    """The normal at each echo's foot, and its distance from there; of lines and circles alike.

    With h along the normal and s aside of the middle, the circle's centre sees the echo along
    (1 + k h, k s): the distance is that vector's length less 1, over k, in a form that allows k = 0.
    """
    n, k = near.normal, near.curvature
    h = (n * points).sum(-1) - near.place
    s = points[:, 1] * n[:, 0] - points[:, 0] * n[:, 1] - near.aside
    up, side = 1 + k * h, k * s
    square = up * up + side * side
    length = jnp.sqrt(jnp.where(square > 0, square, 1))
    normal = n * (up / length)[:, None] + jnp.stack([-n[:, 1], n[:, 0]], axis=-1) * (side / length)[:, None]
    return normal, (2 * h + k * (h * h + s * s)) / (length + 1)
