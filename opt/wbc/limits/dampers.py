"""Velocity dampers near the joints' position limits."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from opt.wbc.pieces import Bounds


def damper_bounds(
    q: Float[Array, "a"],
    lower: Float[Array, "a"],
    upper: Float[Array, "a"],
    speed: Float[Array, "a"],
    start: Float[Array, ""],
    stop: Float[Array, ""],
) -> Bounds:
    """From `start` to `stop` [rad] before a joint limit, the speed towards it falls from `speed` to 0:

        q' <= speed (upper - q - stop) / (start - stop),  not below 0,

    and likewise towards the lower limit (Faverjon and Tournassoud; S1's reference [26]). Further away this
    allows more than `speed`. start 0 leaves it out.
    """
    on = start > 0
    slope = speed / jnp.where(on, start - stop, 1.0)

    def allowed(distance):
        return jnp.where(on, jnp.maximum(slope * (distance - stop), 0.0), jnp.inf)

    return Bounds(-allowed(q - lower), allowed(upper - q))
