"""How far along: a constant speed with smooth starts and stops."""

import jax.numpy as jnp
from jaxtyping import Array, Float

_STEEPEST = 1.875
"""Largest slope of the smooth step 6 x^5 - 15 x^4 + 10 x^3."""


def ramp_time(
    length: Float[Array, "*n"], speed: Float[Array, ""], acceleration: Float[Array, ""]
) -> tuple[Float[Array, "*n"], Float[Array, "*n"]]:
    """Speed that is reached on a way of this length [m/s], and the time to reach it [s].

    The speed rises by the smooth step, which keeps to the acceleration [m/s^2]; a short way never reaches the
    full speed [m/s].
    """
    some = length > 0
    shorter = jnp.sqrt(jnp.where(some, length, 1) * acceleration / _STEEPEST)
    peak = jnp.where(some, jnp.minimum(speed, shorter), speed)
    return peak, _STEEPEST * peak / acceleration


def time_for(
    length: Float[Array, "*n"], speed: Float[Array, ""], acceleration: Float[Array, ""]
) -> Float[Array, "*n"]:
    """Time for a way of this length from rest to rest [s]."""
    peak, ramp = ramp_time(length, speed, acceleration)
    return jnp.where(length > 0, length / peak + ramp, 0)


def travelled(
    time: Float[Array, ""], length: Float[Array, ""], speed: Float[Array, ""], acceleration: Float[Array, ""]
) -> Float[Array, ""]:
    """Way done after some time from rest [m], from 0 to the length, with three continuous derivatives."""
    peak, ramp = ramp_time(length, speed, acceleration)
    brakes = jnp.maximum(length / peak, ramp)
    return jnp.where(length > 0, peak * (_started(time, ramp) - _started(time - brakes, ramp)), 0)


def _started(time: Float[Array, ""], ramp: Float[Array, ""]) -> Float[Array, ""]:
    """Integral of the smooth step over time: 0 before it, time - ramp / 2 after it [s]."""
    x = jnp.clip(time / ramp, 0, 1)
    return ramp * x**4 * (2.5 + x * (x - 3)) + jnp.maximum(time - ramp, 0)
