"""What an edge knows of how two things lie to each other, in numbers that no motion or unit changes."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from nets.agn.anchors import Anchors, Neighbourhoods
from nets.agn.graphs import Graph
from nets.agn.moments import dot

TO_POINTS = 8
"""Numbers on an edge from an anchor to a point."""
TO_ANCHORS = 9
"""Numbers on an edge between anchors."""
_LUMINANCE = 0.299, 0.587, 0.114
_TINY = 1e-12


def to_points(anchors: Anchors, around: Neighbourhoods, coloured) -> Float[Array, "m k f"]:
    """Edges from anchors to the points about them."""
    apart = around.points - anchors.centre[:, None]
    height, aside = _height_and_distance(apart, anchors.normal[:, None])
    size, rough, noise = anchors.size[:, None], anchors.roughness[:, None], anchors.usual[:, None]
    number = jnp.maximum(around.real.sum(1, keepdims=True), 1)[..., None]
    usual = jnp.where(around.real[..., None], around.colour, 0).sum(1, keepdims=True) / number
    tint = around.colour - usual
    light = dot(tint, jnp.asarray(_LUMINANCE, tint.dtype))
    shade = tint - light[..., None]
    hue = jnp.sqrt(dot(shade, shade) + _TINY)
    flat = jnp.broadcast_to(jnp.log(rough / size), height.shape)
    steep = jnp.broadcast_to(anchors.steep[:, None], height.shape)
    return jnp.stack(
        [
            bounded(height / noise),
            bounded(height / rough),
            bounded(height / size),
            aside / size,
            flat,
            steep,
            jnp.where(coloured, 4 * light, 0),
            jnp.where(coloured, 4 * hue, 0),
        ],
        axis=-1,
    )


def to_anchors(
    anchors: Anchors, centre: Float[Array, "m 3"], normal: Float[Array, "m 3"], graph: Graph
) -> Float[Array, "m k f"]:
    """Edges between anchors whose planes have these centres and normals."""
    apart = centre[graph.index] - centre[:, None]
    other = normal[graph.index]
    height, aside = _height_and_distance(apart, normal[:, None])
    back = -dot(apart, other)
    cosine = dot(normal[:, None], other)
    size, noise = anchors.size[:, None], anchors.usual[:, None]
    rough = jnp.log(anchors.roughness / anchors.usual)
    return jnp.stack(
        [
            bounded(height / noise),
            bounded(back / anchors.usual[graph.index]),
            bounded(height / size),
            bounded(back / size),
            aside / (4 * size),
            cosine,
            jnp.sqrt(jnp.maximum(1 - cosine, 0) + _TINY**0.5),
            jnp.broadcast_to(rough[:, None], height.shape),
            rough[graph.index],
        ],
        axis=-1,
    )


def bounded(x: Float[Array, "*n"]) -> Float[Array, "*n"]:
    """x near zero, and never more than 3 either way: outliers are far, however far they are."""
    return x / (1 + jnp.abs(x) / 3)


def _height_and_distance(apart: Float[Array, "*n 3"], normal: Float[Array, "*n 3"]):
    """Over a plane, and along it."""
    height = dot(apart, normal)
    return height, jnp.sqrt(jax.nn.relu(dot(apart, apart) - height * height) + _TINY)
