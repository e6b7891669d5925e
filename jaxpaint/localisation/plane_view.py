"""A small patch of a depth picture against the mapped surface before the brush, point to plane."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from jaxpaint.localisation.evidence import Evidence, evidence_of, lever
from jaxpaint.localisation.robust import inlier_shares


class PlaneSettings(eqx.Module):
    """Numbers of the matching; all traced.

    sigma: standard deviation of one pixel's depth [m]. count: how many independent pixels a patch is worth:
    neighbours share what stereo matching is wrong by. surface_sigma: what the mapped plane itself is off by
    [m], shared by all. gate: distance from the plane beyond which a point is of something else [m]. robust:
    distance at which a point counts a quarter [m].
    """

    sigma: Float[Array, ""] = eqx.field(default=0.002, converter=jnp.asarray)
    count: Float[Array, ""] = eqx.field(default=6.0, converter=jnp.asarray)
    surface_sigma: Float[Array, ""] = eqx.field(default=0.001, converter=jnp.asarray)
    gate: Float[Array, ""] = eqx.field(default=0.10, converter=jnp.asarray)
    robust: Float[Array, ""] = eqx.field(default=0.01, converter=jnp.asarray)


def match_plane(
    points_map: Float[Array, "n 3"],
    valid: Bool[Array, "n"],
    base: Float[Array, "2"],
    point: Float[Array, "3"],
    normal: Float[Array, "3"],
    settings: PlaneSettings | None = None,
) -> Evidence:
    """What a patch of depth says about the error of the base's pose.

    points_map: points of the camera placed by the believed pose [m]. base: (x, y) believed [m]. point [m] and
    unit normal: of the tangent plane of the mapped surface. e is the distance from the plane, J =
    [n_x, n_y, n . perp(p - base)]. Seen are the distance along the normal and, from the patch's width, the
    yaw; of a blank wall never what is along it. Where the wall leans, all but its level part is lost.
    """
    s = settings or PlaneSettings()
    seen = valid & jnp.isfinite(points_map).all(-1)
    points = jnp.where(seen[:, None], points_map, point[None])
    residual = ((points - point[None]) * normal[None]).sum(-1)
    level = jnp.broadcast_to(normal[None, :2], points[:, :2].shape)
    rows = lever(level, points[:, :2], base)
    number = seen.astype(points.dtype).sum()
    worth = jnp.minimum(s.count, number)
    # All of them together weigh as `worth` of them that share the plane's own error.
    each = worth / jnp.maximum(number, 1) / (s.sigma**2 + worth * s.surface_sigma**2)
    precision = jnp.where(seen, each, 0)
    share = inlier_shares(rows, residual, precision, s.robust, s.gate)
    return evidence_of(rows, residual, precision, share)
