"""Plans sampled at the control rate, read at any clock."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float


class Samples(eqx.Module):
    """Rows of numbers at equal steps of time. step [s]. origin: time of the first row [s]."""

    rows: Float[Array | np.ndarray, "t k"]
    step: Float[Array | np.ndarray, ""]
    origin: Float[Array | np.ndarray, ""]

    def at(self, clock: Float[Array, ""]) -> Float[Array, "k"]:
        """The row at `clock`, between neighbours by straight lines; first and last row hold for ever."""
        last = self.rows.shape[0] - 1
        place = jnp.clip((clock - self.origin) / self.step, 0, last)
        index = jnp.clip(jnp.floor(place), 0, max(last - 1, 0))
        pair = jax.lax.dynamic_slice_in_dim(jnp.asarray(self.rows), index.astype(jnp.int32), min(2, last + 1))
        return pair[0] + (place - index) * (pair[-1] - pair[0])
