"""AGN, the attention-aware graph network of S1 section III-A: a noisy cloud's residuals, point by point."""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, PRNGKeyArray

from nets.agn import edges
from nets.agn.anchors import (
    Anchors,
    Neighbourhoods,
    Patch,
    anchors_at,
    block_means,
    neighbourhoods,
)
from nets.agn.blocks import block_order
from nets.agn.descriptor import GraphDescriptor
from nets.agn.graphs import Graph, alike, near
from nets.agn.head import Planes, ResidualHead, blocks_of, points_of
from nets.agn.moments import dot, normal_of, of_points, of_sets
from nets.perceptron import Perceptron

_OWN = 3
"""Numbers that an anchor has of itself, see `Anchors.about`."""


class AGNSettings(eqx.Module):
    """Sizes; all static.

    features: of an anchor. width: of an edge's embedding. heads: of attention. pooled: features of the whole
    patch. blocks: whose points make an anchor's neighbourhood. nearest, further, stride: edges in space to
    the nearest anchors, and to every stride-th after them. groups: where these are looked for. coplanar:
    edges in feature space. beside: anchors whose planes a point may move to. reach: distance that counts in
    feature space as much as one standard deviation of the noise across a plane [anchor sizes]. rounds: how
    often the third descriptor is applied. descriptors: 1 to 3; attention: on or off; less are ablations.
    """

    features: int = eqx.field(static=True, default=24)
    width: int = eqx.field(static=True, default=24)
    heads: int = eqx.field(static=True, default=4)
    pooled: int = eqx.field(static=True, default=16)
    blocks: int = eqx.field(static=True, default=4)
    nearest: int = eqx.field(static=True, default=12)
    further: int = eqx.field(static=True, default=12)
    stride: int = eqx.field(static=True, default=3)
    groups: int = eqx.field(static=True, default=16)
    coplanar: int = eqx.field(static=True, default=32)
    beside: int = eqx.field(static=True, default=10)
    reach: float = eqx.field(static=True, default=16.0)
    rounds: int = eqx.field(static=True, default=2)
    descriptors: int = eqx.field(static=True, default=3)
    attention: bool = eqx.field(static=True, default=True)


class AGN(eqx.Module):
    """Hierarchical feature extractor of graph descriptors, global feature, residual head (S1 figure 4).

    Points are gathered in blocks, each with an anchor. The first descriptor looks from anchors at points, the
    second at the anchors about them, the third in feature space: at anchors on the same plane, however far,
    and again with what it found, by when a plane rests on all that lie on it. Each gives the anchor features,
    and a plane fitted by its attention: the planes hold what wide smooth surfaces say, the features how far
    they hold. A maximum over all anchors joins the local features, and the head moves each point to the
    planes about it: S' = S + residual.
    """

    first: GraphDescriptor
    others: tuple[GraphDescriptor, ...]
    pool: Perceptron
    join: Perceptron
    head: ResidualHead
    settings: AGNSettings

    @classmethod
    def of(cls, settings: AGNSettings | None = None, *, key: PRNGKeyArray) -> "AGN":
        """Weights as training begins with them."""
        s = settings or AGNSettings()
        keys = jax.random.split(key, 3 + s.descriptors)

        def descriptor(edge: int, own: int, key):
            sizes = {"width": s.width, "heads": s.heads, "features": s.features}
            return GraphDescriptor.of(edge, own, **sizes, attention=s.attention, key=key)

        between = edges.TO_ANCHORS + 2 * s.features
        return cls(
            first=descriptor(edges.TO_POINTS, _OWN, keys[0]),
            others=tuple(descriptor(between, _OWN + s.features, keys[k]) for k in range(1, s.descriptors)),
            pool=Perceptron.of([s.features, s.pooled], key=keys[-3]),
            join=Perceptron.of([s.features + s.pooled + _OWN, s.features, 16], key=keys[-2]),
            head=ResidualHead.of(16, s.descriptors, width=s.width, key=keys[-1]),
            settings=s,
        )

    def __call__(self, patch: Patch) -> Float[Array, "n 3"]:
        """The residual of each point of a patch in block order [unit of the points]; zero where not valid."""
        s = self.settings
        centre, valid, look = block_means(patch)
        spread = near(centre, valid, s.nearest + s.further * s.stride, s.groups)
        around = neighbourhoods(patch, spread.columns(slice(s.blocks)))
        anchors = anchors_at(centre, valid, look, around, spread)
        features, planes = self._describe(anchors, around, patch.coloured, spread)
        # Of what is not there the maximum must know nothing.
        pooled = jnp.where(valid[:, None], self.pool(features), -jnp.inf).max(0)
        pooled = jnp.broadcast_to(jnp.where(valid.any(), pooled, 0), (len(features), s.pooled))
        joined = self.join(jnp.concatenate([features, pooled, anchors.about], axis=-1))
        beside = spread.columns(slice(s.beside))
        moved = self.head(blocks_of(patch.points), anchors, planes, joined, beside)
        return jnp.where(patch.valid[:, None], points_of(moved), 0)

    def refined(self, patch: Patch) -> tuple[Float[Array, "n 3"], Bool[Array, " n"]]:
        """The patch's points with their residuals added, and which are real."""
        return patch.points + self(patch), patch.valid

    def _describe(
        self, anchors: Anchors, around: Neighbourhoods, coloured: Bool[Array, ""], spread: Graph
    ) -> tuple[Float[Array, "m f"], Planes]:
        """Features of the anchors after all descriptors, and the planes that each of these gave them."""
        numbers = edges.to_points(anchors, around, coloured)
        features, weight = self.first(numbers, around.real, anchors.about)
        moments = of_points(weight, around.points)
        normal = normal_of(moments, anchors.normal)
        centre = moments.centre
        planes = [(centre, normal)]
        for level, descriptor in enumerate(self.others):
            for _ in range(self.settings.rounds if level else 1):
                graph = self._graph(level, anchors, centre, normal, features, spread)
                lie = edges.to_anchors(anchors, centre, normal, graph)
                apart = features[graph.index] - features[:, None]
                own = jnp.broadcast_to(features[:, None], apart.shape)
                numbers = jnp.concatenate([lie, own, apart], axis=-1)
                about = jnp.concatenate([features, anchors.about], axis=-1)
                gained, weight = descriptor(numbers, graph.real, about)
                features = features + gained
                moments = of_sets(weight, moments[graph.index])
                normal = normal_of(moments, normal)
                # The anchor stays where it is along its plane: the union's centre may be far.
                centre = centre - dot(centre - moments.centre, normal)[:, None] * normal
            planes.append((centre, normal))
        centres, normals = zip(*planes, strict=True)
        return features, Planes(jnp.stack(centres, axis=1), jnp.stack(normals, axis=1))

    def _graph(self, level: int, anchors: Anchors, centre, normal, features, spread: Graph) -> Graph:
        """Of the second descriptor in space, of the third in feature space."""
        s = self.settings
        if level == 0:
            columns = [*range(s.nearest), *range(s.nearest, spread.index.shape[1], s.stride)]
            return spread.columns(jnp.asarray(columns))
        # Normals count as two anchors' sizes would that lie askew by as much.
        scale = jnp.maximum((anchors.valid * anchors.size).sum() / jnp.maximum(anchors.valid.sum(), 1), 1e-12)
        place = jnp.concatenate([centre / (s.reach * scale), 6 * normal, 0.2 * features], axis=-1)
        rough, noise = anchors.roughness, anchors.usual
        return alike(place, centre, normal, rough, noise, anchors.valid, s.coplanar)


def residuals(
    network: AGN,
    points: Float[Array, "n 3"],
    valid: Bool[Array, " n"],
    ray: Float[Array, "n 3"] | None = None,
    colour: Float[Array, "n 3"] | None = None,
) -> Float[Array, "n 3"]:
    """Of one patch in any order; n: a power of two. ray, colour: see `Patch`; None: not known."""
    order = block_order(points, valid)
    middle = jnp.where(valid[:, None], points, 0).sum(0) / jnp.maximum(valid.sum(), 1)
    rays = jnp.zeros_like(points) if ray is None else ray
    colours = jnp.zeros_like(points) if colour is None else colour
    patch = Patch(
        points=jnp.where(valid[:, None], points - middle, 0)[order],
        valid=valid[order],
        ray=rays[order],
        colour=colours[order],
        coloured=jnp.asarray(colour is not None),
    )
    moved = network(patch)
    return jnp.zeros_like(points).at[order].set(moved, unique_indices=True)
