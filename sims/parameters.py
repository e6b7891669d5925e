"""Traced scalar parameters of frozen modules."""

import jax.numpy as jnp
from jaxtyping import Array


def scalar(value: Array | float) -> Array:
    """Converts a field: numbers become leaves of the default float type, arrays keep their own.

    A number left as it is would make a weakly typed leaf, and a sweep that mixes both would compile twice.
    """
    return jnp.asarray(value, float) if isinstance(value, int | float) else value
