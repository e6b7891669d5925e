"""What a ray meets."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float


class Hit(eqx.Module):
    """The first thing along one ray.

    distance: along the unit direction [m], inf where nothing is met. normal: unit, out of what was hit.
    colour: 0..1. valid: whether a sensor gets a reading there; False for a miss, and for what stops the ray
    without being known, as the rim of a captured object. Look at valid before anything else.
    """

    distance: Float[Array, ""]
    normal: Float[Array, "3"]
    colour: Float[Array, "3"]
    valid: Bool[Array, ""]


def hit_where(
    met: Bool[Array, ""], distance: Float[Array, ""], normal: Float[Array, "3"], colour: Float[Array, "3"]
) -> Hit:
    """A hit where `met` holds, else a miss of the same type; distance must be finite either way."""
    return Hit(
        distance=jnp.where(met, distance, jnp.inf),
        normal=jnp.where(met, normal, 0.0),
        colour=jnp.where(met, colour, 0.0),
        valid=met,
    )


def nearer(first: Hit, second: Hit) -> Hit:
    """The closer of two; the first wins a tie."""
    take = first.distance <= second.distance
    return Hit(
        distance=jnp.where(take, first.distance, second.distance),
        normal=jnp.where(take, first.normal, second.normal),
        colour=jnp.where(take, first.colour, second.colour),
        valid=jnp.where(take, first.valid, second.valid),
    )
