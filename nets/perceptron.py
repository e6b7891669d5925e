"""The small dense networks that everything here is made of."""

import itertools
from collections.abc import Sequence

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, PRNGKeyArray


class Perceptron(eqx.Module):
    """Layers x W + b along the last axis, SiLU between them; any axes before it.

    Products of whole blocks of rows: a `vmap` over rows, each a small product, takes several times as long.
    """

    weights: tuple[Float[Array, "inputs outputs"], ...]
    biases: tuple[Float[Array, " outputs"], ...]

    @classmethod
    def of(cls, sizes: Sequence[int], *, last: float = 1.0, key: PRNGKeyArray) -> "Perceptron":
        """Layers of the given sizes, inputs first, drawn after He. last: scale of the last layer, small
        where the network is to begin as if it were not there.
        """
        pairs = list(itertools.pairwise(sizes))
        scales = [*[1.0] * (len(pairs) - 1), last]
        keys = jax.random.split(key, len(pairs))
        weights = [
            scale * (2 / rows) ** 0.5 * jax.random.normal(k, (rows, columns))
            for (rows, columns), scale, k in zip(pairs, scales, keys, strict=True)
        ]
        return cls(tuple(weights), tuple(jnp.zeros(columns) for _, columns in pairs))

    def __call__(self, x: Float[Array, "*batch inputs"]) -> Float[Array, "*batch outputs"]:
        for layer, (weight, bias) in enumerate(zip(self.weights, self.biases, strict=True)):
            if layer:
                x = jax.nn.silu(x)
            x = x @ weight + bias
        return x
