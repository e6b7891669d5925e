"""When a controller gives up: a target that stays out of reach."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

# The brush comes nearer where its error falls by more than this [m].
_PROGRESS = 1e-3
# A clock that is slower than this waits: near a posture in which the arm is stretched the error trembles.
_SLOW = 0.2


class Waiting(eqx.Module):
    """progress: smallest error since the plan's clock all but stopped, as far as it counts as progress [m].
    time: since the last progress [s]. least: smallest error since the clock stopped for good [m], best: the
    arm's joints there [rad].
    """

    progress: Float[Array, ""]
    time: Float[Array, ""]
    least: Float[Array, ""]
    best: Float[Array, "a"]


def not_waiting(arm: Float[Array, "a"]) -> Waiting:
    """A clock that goes on."""
    far = jnp.full((), jnp.finfo(arm.dtype).max, arm.dtype)
    return Waiting(far, jnp.zeros_like(far), far, arm)


def update_waiting(
    state: Waiting,
    error: Float[Array, ""],
    arm: Float[Array, "a"],
    in_time: Float[Array, ""],
    dt: Float[Array, ""],
) -> Waiting:
    """One control step. error: of what is waited for, brush or base [m]. arm: joints [rad]. in_time: share of
    its pace at which the plan's clock goes on.
    """
    slow, stopped, far = in_time < _SLOW, in_time <= 0, not_waiting(arm).least
    nearer = error < state.progress - _PROGRESS
    progress = jnp.where(nearer, error, state.progress)
    return Waiting(
        jnp.where(slow, progress, far),
        jnp.where(slow & ~nearer, state.time + dt, 0.0),
        jnp.where(stopped, jnp.minimum(error, state.least), far),
        jnp.where(stopped & (error > state.least), state.best, arm),
    )
