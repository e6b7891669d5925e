"""Quantiles of a stream, from counts in equal bins."""

from typing import Self

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int


class Histogram(eqx.Module):
    """Counts in bins [0, width), [width, 2 width) and so on; the last bin takes everything beyond."""

    counts: Int[Array, "bins"]
    width: Float[Array, ""]

    @classmethod
    def empty(cls, bins: int, width: float, dtype) -> Self:
        """Nothing counted yet."""
        return cls(counts=jnp.zeros(bins, jnp.int32), width=jnp.asarray(width, dtype))

    def add(self, values: Float[Array, "n"], counted: Bool[Array, "n"]) -> Self:
        """Counts some values >= 0."""
        last = len(self.counts) - 1
        bins = jnp.clip(jnp.where(counted, values, 0) / self.width, 0, last).astype(jnp.int32)
        return type(self)(counts=self.counts.at[bins].add(counted.astype(jnp.int32)), width=self.width)

    def quantile(self, share: float) -> Float[Array, ""]:
        """Smallest edge of a bin with this share at or below it; infinite in the last bin, 0 if empty."""
        below = jnp.cumsum(self.counts)
        total = below[-1]
        index = jnp.argmax(below >= jnp.ceil(share * total))
        edge = (index + 1).astype(self.width.dtype) * self.width
        beyond = jnp.where(index == len(self.counts) - 1, jnp.inf, edge)
        return jnp.where(total > 0, beyond, 0)
