"""How a brush stands on the wall at one moment."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from sims.scenes.charts import AbstractChart

# Beyond this cosine between brush axis and wall a brush lies on its side; nothing sensible can be said.
_LEAST_COSINE = 0.2


class Contact(eqx.Module):
    """One sample of a brush at a wall; with a leading axis, many in the order of time.

    uv: foot of the brush tip on the wall [m]. height: of the tip above the wall, > 0 away from it, 0 as
    planned [m]. lean: tangent of the angle between brush axis and inward normal, along u and v [1]: the
    direction into which the bristles point. speed: of the tip along the wall [m/s]. duration: time that this
    sample stands for [s], 0 for samples that do not count. pen: commanded state, 0 up to 1 down.
    """

    uv: Float[Array, "*time 2"]
    height: Float[Array, "*time"]
    lean: Float[Array, "*time 2"]
    speed: Float[Array, "*time"]
    duration: Float[Array, "*time"]
    pen: Float[Array, "*time"]


def contact(
    chart: AbstractChart,
    p_map_brush: Float[Array, "3"],
    axis_map_brush: Float[Array, "3"],
    v_map_brush: Float[Array, "3"],
    duration: Float[Array, ""],
    pen: Float[Array, ""],
) -> Contact:
    """The contact of a true brush pose with the true wall.

    axis_map_brush: unit, from the handle into the wall. A brush that lies on its side or points away from
    the wall is reported as one metre off it.
    """
    uv, height = chart.to_uv(p_map_brush)
    across, up, normal = wall_axes(chart.normal(uv))
    into = -_dot(axis_map_brush, normal)
    upright = into > _LEAST_COSINE
    scale = 1 / jnp.where(upright, into, 1)
    lean = jnp.stack([_dot(axis_map_brush, across), _dot(axis_map_brush, up)]) * scale
    along = v_map_brush - _dot(v_map_brush, normal) * normal
    return Contact(
        uv=uv,
        height=jnp.where(upright, height, 1),
        lean=lean,
        speed=_length(along),
        duration=duration,
        pen=pen,
    )


def wall_axes(
    normal: Float[Array, "3"],
) -> tuple[Float[Array, "3"], Float[Array, "3"], Float[Array, "3"]]:
    """Unit directions of growing u and v at a wall with this normal, and the normal (right-handed).

    Walls only: a level surface (normal along z) has no direction of its own and gets u = -y.
    """
    level = jnp.sqrt(jnp.maximum(normal[0] ** 2 + normal[1] ** 2, 1e-12))
    flat = level < 1e-4
    across = jnp.stack([-normal[1] / level, normal[0] / level, jnp.zeros_like(level)])
    across = jnp.where(flat, jnp.asarray([0, -1, 0], normal.dtype), across)
    up = jnp.stack(
        [
            normal[1] * across[2] - normal[2] * across[1],
            normal[2] * across[0] - normal[0] * across[2],
            normal[0] * across[1] - normal[1] * across[0],
        ]
    )
    return across, up, normal


def _dot(a, b):
    return (a * b).sum(-1)


def _length(vector):
    # The root has no gradient at zero: a standing brush gets 0 and gradient 0 (double where).
    squares = _dot(vector, vector)
    moving = squares > 0
    return jnp.where(moving, jnp.sqrt(jnp.where(moving, squares, 1)), 0)
