"""Marks of the strokes laid so far: where they truly are, and where the robot believed to lay them."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from jaxpaint.kinematics.pose import Pose
from opt.controller import Surface

# So many marks are remembered, this far apart or further [m]: 1.6 m of strokes, or a few rows of a fill.
_MARKS, _APART = 64, 0.025
# A stroke's direction is that from the mark before, unless that is further away [m].
_SAME_STROKE = 0.06
# Of the picture in colour: tangents of half its angles of view, 69 by 42 degrees.
_HALF_VIEW = 0.687, 0.384
# The stroke that is being laid says nothing of drift: marks count once they are this old [s].
_OLD = 4.0


class Marks(eqx.Module):
    """The last marks, newest first. true, laid (as believed), along (the stroke's unit direction, 0 where it
    is not known), normal (of the wall): map frame [m]. variance: of the believed place then [m^2]. time: [s],
    infinite where there is no mark.
    """

    true: Float[Array, "m 3"]
    laid: Float[Array, "m 3"]
    along: Float[Array, "m 3"]
    normal: Float[Array, "m 3"]
    variance: Float[Array, "m"]
    time: Float[Array, "m"]


def no_marks(dtype) -> Marks:
    """A clean wall."""
    none = jnp.zeros((_MARKS, 3), dtype)
    return Marks(none, none, none, none, none[:, 0], none[:, 0] + jnp.inf)


def with_mark(
    marks: Marks,
    true: Float[Array, "3"],
    laid: Float[Array, "3"],
    surface: Surface,
    variance: Float[Array, ""],
    time: Float[Array, ""],
) -> Marks:
    """One more, if the pen is down and has gone on from the last one."""
    step = laid - marks.laid[0]
    way = jnp.sqrt((step * step).sum() + 1e-12)
    first = ~jnp.isfinite(marks.time[0])
    go_on = (surface.known > 0) & (first | (way > _APART))
    joined = ~first & (way < _SAME_STROKE)
    along = jnp.where(joined, step / way, 0.0)
    new = Marks(true, laid, along, surface.normal, variance, time)
    pushed = [
        jnp.where(go_on, jnp.concatenate([x[None], old[:-1]]), old)
        for x, old in zip(_fields(new), _fields(marks), strict=True)
    ]
    return Marks(*pushed)


def in_view(
    marks: Marks, T_map_camera: Pose, time: Float[Array, ""]
) -> tuple[Float[Array, "m 3"], Bool[Array, "m"]]:
    """Places of the marks in the frame of the camera as it truly stands [m], and which it sees."""
    away = marks.true - T_map_camera.p
    local = (away[:, :, None] * T_map_camera.R[None]).sum(1)
    depth = jnp.maximum(local[:, 2], 1e-3)
    x, y = jnp.abs(local[:, 0]) / depth, jnp.abs(local[:, 1]) / depth
    ahead = (local[:, 2] > 0.05) & (local[:, 2] < 1.0)
    old = time - marks.time > _OLD
    return local, ahead & (x < _HALF_VIEW[0]) & (y < _HALF_VIEW[1]) & old


def _fields(marks: Marks) -> tuple[Array, ...]:
    return marks.true, marks.laid, marks.along, marks.normal, marks.variance, marks.time
