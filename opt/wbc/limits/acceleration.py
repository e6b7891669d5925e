"""Acceleration limits, which come last: what cannot be met in one step is approached."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from opt.wbc.pieces import Bounds


def within_acceleration(bounds: Bounds, velocity: Float[Array, "n"], step: Float[Array, "n"]) -> Bounds:
    """The bounds as far as they can be met: velocities at most `step` = a dt from the present one.

        clip(lower, v - step, v + step) <= q <= clip(upper, v - step, v + step)

    An infinite step leaves it out.
    """
    low, high = velocity - step, velocity + step
    return Bounds(jnp.clip(bounds.lower, low, high), jnp.clip(bounds.upper, low, high))


def braked(velocity: Float[Array, "n"], step: Float[Array, "n"]) -> Float[Array, "n"]:
    """The velocity one step later where each joint brakes as hard as it can."""
    return velocity - jnp.clip(velocity, -step, step)
