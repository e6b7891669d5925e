"""The graph descriptor (GD) of S1 figure 4: attention over a graph's edges gathers features and a plane."""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, PRNGKeyArray

from nets.perceptron import Perceptron

_NEVER = -1e9


class GraphDescriptor(eqx.Module):
    """Multi-head attention over edges.

    edge: from an edge's numbers (the two features, how they lie to each other) to an embedding. score: of an
    embedding for each head. out: the heads' sums, with what the anchor knows of itself, to its features. The
    last head weighs what the plane is fitted to. attention: off, all edges count alike (an ablation).
    """

    edge: Perceptron
    score: Perceptron
    out: Perceptron
    attention: bool = eqx.field(static=True, default=True)

    @classmethod
    def of(
        cls,
        edge: int,
        own: int,
        *,
        width: int,
        heads: int,
        features: int,
        attention: bool,
        key: PRNGKeyArray,
    ) -> "GraphDescriptor":
        """edge, own: how many numbers an edge has, and an anchor of its own. width: of an embedding."""
        first, second, third = jax.random.split(key, 3)
        return cls(
            Perceptron.of([edge, width, width], key=first),
            # Small: it begins with almost equal weights, which is the plain fit.
            Perceptron.of([width, heads + 1], last=0.1, key=second),
            Perceptron.of([heads * width + own, features], key=third),
            attention,
        )

    def __call__(
        self, edges: Float[Array, "m k e"], real: Bool[Array, "m k"], own: Float[Array, "m o"]
    ) -> tuple[Float[Array, "m f"], Float[Array, "m k"]]:
        """New features of the anchors, and the weights for their planes, which sum to one."""
        embedded = self.edge(edges)
        weight = self._weights(embedded, real)
        gathered = jnp.einsum("mkh,mke->mhe", weight[..., :-1], embedded)
        features = self.out(jnp.concatenate([gathered.reshape(len(own), -1), own], axis=-1))
        return jax.nn.silu(features), weight[..., -1]

    def _weights(self, embedded, real) -> Float[Array, "m k h"]:
        score = self.score(embedded)
        if not self.attention:
            score = jnp.zeros_like(score)
        weight = jax.nn.softmax(jnp.where(real[..., None], score, _NEVER), axis=1)
        return jnp.where(real[..., None], weight, 0)
