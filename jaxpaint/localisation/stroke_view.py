"""Edges of paint already laid, seen again: what the base is off by across a stroke."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from jaxpaint.kinematics.rotations import cross
from jaxpaint.localisation.evidence import Evidence, evidence_of, lever
from jaxpaint.localisation.robust import inlier_shares


class StrokeSettings(eqx.Module):
    """Numbers of the matching; all traced.

    sigma: standard deviation of one mark as the camera sees it [m]. laid_sigma: of where the strokes were
    laid, shared by all marks of a look [m]. gate: distance beyond which a mark is of another stroke [m].
    robust: distance at which a mark counts a quarter [m].
    """

    sigma: Float[Array, ""] = eqx.field(default=0.001, converter=jnp.asarray)
    laid_sigma: Float[Array, ""] = eqx.field(default=0.001, converter=jnp.asarray)
    gate: Float[Array, ""] = eqx.field(default=0.05, converter=jnp.asarray)
    robust: Float[Array, ""] = eqx.field(default=0.01, converter=jnp.asarray)


def match_stroke(
    seen: Float[Array, "m 3"],
    laid: Float[Array, "m 3"],
    along: Float[Array, "m 3"],
    normal: Float[Array, "m 3"],
    valid: Bool[Array, "m"],
    base: Float[Array, "2"],
    settings: StrokeSettings | None = None,
) -> Evidence:
    """What marks of earlier strokes say about the error of the base's pose.

    seen: where the camera sees each mark now, placed in the map by the believed pose [m]. laid: where the
    robot believed to lay it [m]. along: the stroke's unit direction there. normal: of the wall, unit. valid:
    which of the marks are seen. base: (x, y) believed [m].

    An edge shows no offset along itself: e = a . (seen - laid) with a = normal x along, in the wall's tangent
    plane, and J = [a_x, a_y, a . perp(p - base)] of its level part. A level stroke on an upright wall has an
    upright a and says nothing of the base. The pose becomes consistent with the strokes, right or wrong.
    """
    s = settings or StrokeSettings()
    known = valid & jnp.isfinite(seen).all(-1) & jnp.isfinite(laid).all(-1)
    known = known & jnp.isfinite(along).all(-1) & jnp.isfinite(normal).all(-1)
    seen, laid, along, normal = (jnp.where(known[:, None], v, 0) for v in (seen, laid, along, normal))
    across = cross(normal, along)
    residual = (across * (seen - laid)).sum(-1)
    rows = lever(across[:, :2], seen[:, :2], base)
    number = known.astype(residual.dtype).sum()
    precision = known / (s.sigma**2 + number * s.laid_sigma**2)
    share = inlier_shares(rows, residual, precision, s.robust, s.gate)
    return evidence_of(rows, residual, precision, share)
