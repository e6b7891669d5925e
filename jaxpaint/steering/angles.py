"""Angles, which come round again after a whole turn."""

import jax.numpy as jnp
from jaxtyping import Array, Float


def wrap(angle: Float[Array, "*s"]) -> Float[Array, "*s"]:
    """The same angle in [-pi, pi)."""
    return angle - 2 * jnp.pi * jnp.floor((angle + jnp.pi) / (2 * jnp.pi))
