"""The low-speed rule S1-(12): the base moves fast enough to be measured, or not at all."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.decisions.thresholds import Thresholds
from opt.wbc.pieces import Bounds


def is_signed(thresholds: Thresholds) -> Array:
    """Whether the base goes to stations: the rule is on, and not as printed."""
    return (thresholds.low_speed_scale > 0) & (thresholds.one_sided <= 0)


def is_printed(thresholds: Thresholds) -> Array:
    """Whether the rule is on as printed."""
    return (thresholds.low_speed_scale > 0) & (thresholds.one_sided > 0)


def low_speed_bounds(
    demand: Float[Array, "3"],
    gate: Float[Array, ""],
    brush: Float[Array, "3"],
    speed: Float[Array, "3"],
    thresholds: Thresholds,
) -> Bounds:
    """Bounds of the base's velocity (x, y [m/s], yaw [rad/s], map frame). S: `low_speed_scale`.

        signed (default)   min(d, 0) <= q <= max(d, 0)      d: demanded velocity towards the station
        one-sided          S v_x <= q_x,  S v_y <= q_y      v: reference velocity of the brush

    One-sided is S1-(12) as printed: Q'min[0, 1] = [S(dx), S(dy)] bounds from below only and whatever the sign
    of the motion: a brush that moves along +x pushes the base at least so fast, and one that moves along -x
    leaves it free. It holds no more than the speed limit. S = 0 leaves the rule out. gate: 0 closes all
    bounds to zero, which is the halt S1-(13).
    """
    signed = is_signed(thresholds)
    least = jnp.concatenate([thresholds.low_speed_scale * brush[:2], -speed[2:]])
    printed = jnp.where(is_printed(thresholds), jnp.clip(least, -speed, speed), -speed)
    lower = jnp.where(signed, jnp.minimum(demand, 0.0), printed)
    upper = jnp.where(signed, jnp.maximum(demand, 0.0), speed)
    return Bounds(_gated(lower, gate), _gated(upper, gate))


def _gated(bound: Float[Array, "3"], gate: Float[Array, ""]) -> Float[Array, "3"]:
    """bound * gate, and 0 where the gate is shut however wide the bound is."""
    opened = gate > 0
    return jnp.where(opened, bound, 0.0) * jnp.where(opened, gate, 1.0)
