"""When the base stands still: S1-(13) with a latch, a dwell and a release."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.decisions.relax import exceeds
from jaxpaint.decisions.thresholds import Thresholds


class HaltState(eqx.Module):
    """halted: 1 while the base is halted. travel: base travel since it was let go [m]. rest: time since it
    was halted [s]. halts: how often it was halted.
    """

    halted: Float[Array, ""]
    travel: Float[Array, ""]
    rest: Float[Array, ""]
    halts: Float[Array, ""]


def initial_halt(dtype) -> HaltState:
    """A base that stands still and may be let go at once."""
    zero = jnp.zeros((), dtype)
    return HaltState(halted=zero + 1, travel=zero, rest=zero + 1e3, halts=zero)


def update_halt(
    state: HaltState,
    travelled: Float[Array, ""],
    distance: Float[Array, ""],
    arrived: Float[Array, ""],
    worthwhile: Float[Array, ""],
    thresholds: Thresholds,
    dt: Float[Array, ""],
) -> HaltState:
    """One control step of the latch.

    travelled: base travel of the last step as odometry sees it [m]; never the true one. distance: how far the
    brush is from its best place before the arm [m]. arrived: 1 when the base stands where it was sent; it
    halts then too. worthwhile: 1 where the way to go is worth a start. With Theta infinite the latch is off:
    the base is never halted, unless it parks.
    """
    t = thresholds
    enabled = (jnp.isfinite(t.halt_travel) | (t.park > 0)).astype(travelled.dtype)
    travel = state.travel + travelled * (1 - state.halted)
    stop = jnp.maximum(exceeds(travel, t.halt_travel, t.halt_temperature), arrived) * (1 - state.halted)
    rested = (state.rest >= t.dwell).astype(travelled.dtype)
    go = (
        exceeds(distance, t.release_margin, t.release_temperature)
        * rested
        * worthwhile
        * (1 - arrived)
        * state.halted
    )
    halted = (state.halted + stop - go) * enabled
    return HaltState(
        halted=halted,
        travel=travel * (1 - stop),
        rest=(state.rest + dt) * (1 - stop),
        halts=state.halts + stop * enabled,
    )
