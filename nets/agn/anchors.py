"""Anchors: what the graphs' nodes know of the surface about them."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from jaxpaint.mapping.planes import norm, unit
from nets.agn.blocks import BLOCK
from nets.agn.graphs import Graph
from nets.agn.moments import Moments, across, dot, normal_of, of_points

_TINY = 1e-6


class Patch(eqx.Module):
    """Points of a cloud in block order, see `nets.agn.blocks`.

    points: any unit, about any origin. ray: unit, from the camera to the point; zero where it is not known.
    colour: 0 to 1; coloured: whether it is known.
    """

    points: Float[Array, "n 3"]
    valid: Bool[Array, " n"]
    ray: Float[Array, "n 3"]
    colour: Float[Array, "n 3"]
    coloured: Bool[Array, ""]


class Neighbourhoods(eqx.Module):
    """Points about each anchor: those of the blocks next to it, as edges from the anchor to points."""

    points: Float[Array, "m k 3"]
    colour: Float[Array, "m k 3"]
    real: Bool[Array, "m k"]


class Anchors(eqx.Module):
    """m anchors. centre: mean of a block's points. look: towards the camera, as far as that is known.

    size: root mean square distance of the neighbourhood's points. roughness: their standard deviation across
    their plane. usual: the mean roughness in a wider neighbourhood, in logarithms: there the noise, as most
    surfaces are smooth. It differs by place: noise grows with the square of the distance.
    moments, normal: of the neighbourhood. steep: cosine between normal and view, 0 where it is not known.
    """

    valid: Bool[Array, " m"]
    centre: Float[Array, "m 3"]
    size: Float[Array, " m"]
    roughness: Float[Array, " m"]
    usual: Float[Array, " m"]
    moments: Moments
    normal: Float[Array, "m 3"]
    steep: Float[Array, " m"]

    @property
    def about(self) -> Float[Array, "m 3"]:
        """What is told of each anchor itself: roughness by size and by the usual one, steepness."""
        flat = jnp.log(self.roughness / self.size)
        return jnp.stack([flat, jnp.log(self.roughness / self.usual), self.steep], axis=-1)


def block_means(patch: Patch) -> tuple[Float[Array, "m 3"], Bool[Array, " m"], Float[Array, "m 3"]]:
    """Of each block: centre, whether it has points, mean direction to the camera."""
    real = patch.valid.reshape(-1, BLOCK)
    number = jnp.maximum(real.sum(1), 1)[:, None]

    def mean(rows):
        return jnp.where(real[..., None], rows.reshape(-1, BLOCK, 3), 0).sum(1) / number

    return mean(patch.points), real.any(1), -mean(patch.ray)


def neighbourhoods(patch: Patch, graph: Graph) -> Neighbourhoods:
    """The points of each anchor's neighbours in the graph."""
    shape = len(graph.index), graph.index.shape[1] * BLOCK

    def of(rows):
        return rows.reshape(-1, BLOCK, *rows.shape[1:])[graph.index]

    real = of(patch.valid) & graph.real[..., None]
    return Neighbourhoods(
        of(patch.points).reshape(*shape, 3), of(patch.colour).reshape(*shape, 3), real.reshape(shape)
    )


def anchors_at(
    centre: Float[Array, "m 3"],
    valid: Bool[Array, " m"],
    look: Float[Array, "m 3"],
    around: Neighbourhoods,
    wide: Graph,
) -> Anchors:
    """Anchors with the plain plane through their neighbourhoods. wide: the anchors that say what is usual."""
    weight = around.real / jnp.maximum(around.real.sum(1, keepdims=True), 1)
    moments = of_points(weight, around.points)
    known = norm(look) > 0
    towards = unit(look, otherwise=_side(centre, valid))
    normal = normal_of(moments, towards)
    apart = around.points - centre[:, None]
    size = jnp.sqrt((weight * dot(apart, apart)).sum(1) + _TINY**2)
    roughness = jnp.sqrt(jnp.maximum(across(moments, normal), 0) + (_TINY * size) ** 2)
    share = wide.real / jnp.maximum(wide.real.sum(1, keepdims=True), 1)
    usual = jnp.exp((share * jnp.log(roughness)[wide.index]).sum(1))
    steep = jnp.where(known, dot(normal, towards), 0)
    return Anchors(valid, centre, size, roughness, usual, moments, normal, steep)


def _side(centre: Float[Array, "m 3"], valid: Bool[Array, " m"]) -> Float[Array, "3"]:
    """A direction across the whole patch: normals are turned to it where nobody knows the camera."""
    share = valid / jnp.maximum(valid.sum(), 1)
    along = jnp.asarray([0.48, 0.64, 0.6], centre.dtype)  # along no axis, as surfaces often are
    return normal_of(of_points(share[None], centre[None]), along[None])[0]
