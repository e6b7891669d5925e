"""The residual of each point: how it lies to the planes of the anchors about it, weighed by attention."""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, PRNGKeyArray

from nets.agn.anchors import Anchors
from nets.agn.blocks import BLOCK
from nets.agn.edges import bounded
from nets.agn.graphs import Graph
from nets.agn.moments import dot
from nets.perceptron import Perceptron

_NEVER = -1e9
_TINY = 1e-12


class Planes(eqx.Module):
    """Of each anchor and descriptor: a point of its plane, and the unit normal."""

    centre: Float[Array, "m levels 3"]
    normal: Float[Array, "m levels 3"]


class ResidualHead(eqx.Module):
    """Candidates are the planes of the nearest anchors, one of each descriptor: a point moves to their
    weighted mean, along their normals. node: what an anchor's features say of its planes. mix, score: of how
    the point lies to the planes.
    """

    node: Perceptron
    mix: Perceptron
    score: Perceptron

    @classmethod
    def of(cls, features: int, levels: int, *, width: int, key: PRNGKeyArray) -> "ResidualHead":
        """features: of an anchor. levels: descriptors."""
        first, second, third = jax.random.split(key, 3)
        numbers = 3 * levels + 2
        return cls(
            Perceptron.of([features, width], key=first),
            Perceptron.of([numbers, width], key=second),
            Perceptron.of([width, 16, levels], last=0.1, key=third),
        )

    def __call__(
        self,
        blocks: Float[Array, "m b 3"],
        anchors: Anchors,
        planes: Planes,
        features: Float[Array, "m f"],
        graph: Graph,
    ) -> Float[Array, "m b 3"]:
        """What to add to each point."""
        normal = planes.normal[graph.index]
        # About the block's own anchor, so that small differences are not lost in large numbers.
        local = blocks - anchors.centre[:, None]
        centre = planes.centre[graph.index] - anchors.centre[:, None, None]
        height = dot(local[:, :, None, None], normal[:, None]) - dot(centre, normal)[:, None]
        apart = local[:, :, None] - centre[:, None, :, -1]
        aside = jax.nn.relu(dot(apart, apart) - height[..., -1] ** 2)
        numbers = self._numbers(height, jnp.sqrt(aside + _TINY), anchors, graph)
        mixed = jax.nn.silu(self.mix(numbers) + self.node(features)[graph.index][:, None])
        score = jnp.where(graph.real[:, None, :, None], self.score(mixed), _NEVER)
        # The plane of the widest view is the one to trust where nothing else is known.
        score = score - jnp.arange(score.shape[-1])[::-1]
        weight = jax.nn.softmax(score.reshape(*score.shape[:2], -1), axis=-1).reshape(score.shape)
        return -jnp.einsum("mbkl,mkla->mba", weight * height, normal)

    def _numbers(self, height, aside, anchors: Anchors, graph: Graph):
        """Of each point and anchor next to it: heights over its planes by the noise, distance, roughness."""
        aside = aside / anchors.size[graph.index][:, None]
        by_noise = bounded(height / anchors.usual[:, None, None, None])
        by_roughness = bounded(height / anchors.roughness[graph.index][:, None, :, None])
        rough = jnp.log(anchors.roughness / anchors.usual)[graph.index]
        rest = jnp.stack([aside, jnp.broadcast_to(rough[:, None], aside.shape)], axis=-1)
        return jnp.concatenate([by_noise, jnp.abs(by_noise), by_roughness, rest], axis=-1)


def points_of(blocks: Float[Array, "m b 3"]) -> Float[Array, "n 3"]:
    """Blocks as one cloud."""
    return blocks.reshape(-1, 3)


def blocks_of(points: Float[Array, "n 3"]) -> Float[Array, "m b 3"]:
    """A cloud in block order as blocks."""
    return points.reshape(-1, BLOCK, 3)
