"""How far along: a constant speed with starts and stops by S-curve."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.trajectories.s_curve import progress, s_curve

# Time over which acceleration builds up, over the time that the speed would take at once [-], and the least
# [s]: five control periods, since the whole robot follows.
_ROUNDING, _LEAST = 0.3, 0.1


def time_for(
    length: Float[Array, "*n"], speed: Float[Array, ""], acceleration: Float[Array, ""]
) -> Float[Array, "*n"]:
    """Time for a way of this length from rest to rest [s]."""
    return _curve(length, speed, acceleration).duration


def travelled(
    time: Float[Array, "*n"],
    length: Float[Array, "*n"],
    speed: Float[Array, ""],
    acceleration: Float[Array, ""],
) -> Float[Array, "*n"]:
    """Way done after some time from rest [m], from 0 to the length, with two continuous derivatives."""
    return progress(_curve(length, speed, acceleration), time).way


def _curve(length, speed, acceleration):
    length = jnp.asarray(length)
    return s_curve(length, speed, acceleration, rounding=_ROUNDING, least=_LEAST)
