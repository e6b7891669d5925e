"""Bounds on velocities: speed, acceleration, dampers near joint limits, and S1-(12) for the base."""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float


class Bounds(NamedTuple):
    """lower <= velocity <= upper."""

    lower: Float[Array, "n"]
    upper: Float[Array, "n"]


def speed_bounds(limit: Float[Array, "n"]) -> Bounds:
    """Symmetric speed limits."""
    return Bounds(-limit, limit)


def damped(bounds: Bounds, q: Float[Array, "n"], lower, upper, start, stop) -> Bounds:
    """Velocity dampers: from `start` to `stop` [rad] before a joint limit, speed towards it falls to 0."""
    limit = bounds.upper
    to_upper = limit * (upper - q - stop) / (start - stop)
    to_lower = limit * (q - lower - stop) / (start - stop)
    return Bounds(
        jnp.maximum(bounds.lower, -jnp.maximum(to_lower, 0.0)),
        jnp.minimum(bounds.upper, jnp.maximum(to_upper, 0.0)),
    )


def within_acceleration(bounds: Bounds, velocity: Float[Array, "n"], step: Float[Array, "n"]) -> Bounds:
    """The bounds as far as they can be met: velocities that differ from the present one by at most `step`."""
    low, high = velocity - step, velocity + step
    return Bounds(jnp.clip(bounds.lower, low, high), jnp.clip(bounds.upper, low, high))


def demanded_motion_bounds(demand: Float[Array, "3"], gate: Float[Array, ""]) -> Bounds:
    """S1-(12) in its signed form: the base moves with the demanded motion or not at all.

    As printed, Q'min = [S(dx), S(dy)] bounds from below only, whatever the sign of the motion. Here each
    component lies between zero and the demand, and at zero while the gate is shut.
    """
    return Bounds(jnp.minimum(demand, 0.0) * gate, jnp.maximum(demand, 0.0) * gate)


def joined(first: Bounds, second: Bounds) -> Bounds:
    """The bounds of two groups of velocities, one after the other."""
    return Bounds(jnp.concatenate([first.lower, second.lower]), jnp.concatenate([first.upper, second.upper]))
