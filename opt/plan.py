"""Plans sampled at the control rate, read at any clock."""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float


class Samples(eqx.Module):
    """Rows of numbers at equal steps of time from zero. step [s]."""

    rows: Float[Array, "t k"]
    step: Float[Array, ""]

    def at(self, clock: Float[Array, ""]) -> tuple[Float[Array, "k"], Float[Array, ""]]:
        """The row that holds at `clock`, and the time since that row [s]; the last row holds for ever."""
        last = self.rows.shape[0] - 1
        index = jnp.clip(jnp.floor(clock / self.step + 1e-3), 0, last)
        row = jax.lax.dynamic_index_in_dim(self.rows, index.astype(jnp.int32), keepdims=False)
        return row, jnp.where(index < last, clock - index * self.step, 0.0)
