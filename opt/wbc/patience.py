"""When a controller gives up: a target that stays out of reach."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

# The brush comes nearer where its error falls by more than this [m].
_PROGRESS = 1e-3
# A clock that is slower than this waits: near a posture in which the arm is stretched the error trembles.
_SLOW = 0.2


class Waiting(eqx.Module):
    """least: smallest error since the plan's clock stopped [m]. time: since it last fell [s]."""

    least: Float[Array, ""]
    time: Float[Array, ""]


def not_waiting(dtype) -> Waiting:
    """A clock that goes on."""
    return Waiting(jnp.full((), jnp.finfo(dtype).max, dtype), jnp.zeros((), dtype))


def update_waiting(
    state: Waiting, error: Float[Array, ""], in_time: Float[Array, ""], dt: Float[Array, ""]
) -> Waiting:
    """One control step. error: of what is waited for, brush or base [m]. in_time: share of its pace at which
    the plan's clock goes on.
    """
    none, stopped = not_waiting(error.dtype), in_time < _SLOW
    nearer = error < state.least - _PROGRESS
    least = jnp.where(stopped, jnp.where(nearer, error, state.least), none.least)
    return Waiting(least, jnp.where(stopped & ~nearer, state.time + dt, 0.0))
