"""The S-curve: from rest to rest, fast, within limits of speed and acceleration and without their jumps."""

from typing import NamedTuple

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

ROUNDING = 0.1
"""Time over which acceleration builds up, over the time that the speed would take to build up at once [-]."""

LEAST = 0.04
"""The least such time [s]: two control periods, so that what is sampled still looks continuous."""


class SCurve(eqx.Module):
    """A way that is done with speed rising over `ramp` [s] to its peak, held, and falling again.

    length: of the way [m or rad, or 1 for a share of it]. duration, ramp [s]. build_up: time in which
    acceleration goes from zero to its largest [s]. Leading axes stack curves. A curve without length takes no
    time.
    """

    length: Float[Array, "*n"]
    duration: Float[Array, "*n"]
    ramp: Float[Array, "*n"]
    build_up: Float[Array, "*n"]

    @property
    def peak(self) -> Float[Array, "*n"]:
        """The largest speed: what is needed to have done the whole way at the end, to the last digit."""
        cruise = self.duration - self.ramp
        return self.length / jnp.where(self.length > 0, cruise, 1)


class Progress(NamedTuple):
    """Way done, and its first and second derivative with respect to time."""

    way: Float[Array, "*n"]
    speed: Float[Array, "*n"]
    acceleration: Float[Array, "*n"]


def s_curve(
    length: Float[Array, "*n"],
    speed: Float[Array, "*n"],
    acceleration: Float[Array, "*n"],
    *,
    rounding: float | Float[Array, ""] = ROUNDING,
    least: float | Float[Array, ""] = LEAST,
) -> SCurve:
    """The curve for a way of this length, at most as fast and as steep as the limits.

    Seven phases, of which some may be empty; at most 5.2 % slower (rounding 0.1) than if acceleration could
    jump, but for ways so short that `least` rules.
    """
    some = length > 0
    way = jnp.where(some, length, 1)  # the root's gradient is infinite at 0
    reached = jnp.minimum(speed, jnp.sqrt(way * acceleration))
    build_up = jnp.maximum(rounding * reached / acceleration, least)
    # without time at full speed: way = peak (peak / acceleration + build_up)
    turning = 2 * way / (build_up + jnp.sqrt(build_up * build_up + 4 * way / acceleration))
    peak = jnp.minimum(jnp.minimum(speed, turning), way / (2 * build_up))
    ramp = build_up + jnp.maximum(peak / acceleration, build_up)
    zero = jnp.zeros_like(way)
    return SCurve(jnp.where(some, length, zero), jnp.where(some, way / peak + ramp, zero), ramp, build_up)


def stretched(curve: SCurve, factor: Float[Array, "*n"]) -> SCurve:
    """The same way in `factor` times the time."""
    return SCurve(curve.length, curve.duration * factor, curve.ramp * factor, curve.build_up * factor)


def progress(curve: SCurve, time: Float[Array, "*n"]) -> Progress:
    """Where the curve is at a time since its start [s]; at rest before and after."""
    rise = time / curve.ramp
    fall = (time - (curve.duration - curve.ramp)) / curve.ramp
    corner = curve.build_up / curve.ramp
    (p0, v0, a0), (p1, v1, a1) = _ramp(rise, corner), _ramp(fall, corner)
    moves = curve.length > 0
    inside = moves & (time > 0) & (time < curve.duration)
    way = jnp.clip(curve.peak * curve.ramp * (p0 - p1), 0, curve.length)
    return Progress(
        jnp.where(moves, jnp.where(time < curve.duration, way, curve.length), 0),
        jnp.where(inside, curve.peak * (v0 - v1), 0),
        jnp.where(inside, curve.peak / curve.ramp * (a0 - a1), 0),
    )


def _ramp(x, corner):
    """A speed that rises from 0 to 1 while x does; its acceleration is a trapezoid with such corners.

    Returns its integral, itself, its derivative: sums of powers, each of which begins at a corner.
    """
    y = jnp.clip(x, 0, 1)
    steep = 1 / (corner * (1 - corner))
    b, c = jnp.maximum(y - corner, 0), jnp.maximum(y - (1 - corner), 0)
    way = steep / 6 * (y * y * y - b * b * b - c * c * c) + jnp.maximum(x - 1, 0)
    return way, steep / 2 * (y * y - b * b - c * c), jnp.where(x < 1, steep * (y - b - c), 0)
