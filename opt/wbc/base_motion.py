"""Where the base should go and how fast: the low-speed rule S1-(12) and the halt S1-(13)."""

from typing import NamedTuple

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.decisions.halting import HaltState, update_halt
from jaxpaint.decisions.thresholds import Thresholds
from jaxpaint.steering import AbstractDrive, wrap
from opt.wbc.settings import ControllerSettings

# A base nearer to its station than this has arrived [m].
_ARRIVED = 0.01
# A halted base does not start for less than this way [m]: every start costs time and scrub.
_WORTH_A_START = 0.12
# Approach speed per metre that is left [1/s], and the least speed, six times the dead band [m/s].
_APPROACH, _LEAST = 1.5, 0.03


class BaseDemand(NamedTuple):
    """velocity: demanded base velocity in the map frame (x, y [m/s], yaw [rad/s]). gate: 1 where the base may
    move. steer: 1 while the wheels should turn towards the demand. halt: the latch.
    """

    velocity: Float[Array, "3"]
    gate: Float[Array, ""]
    steer: Float[Array, ""]
    halt: HaltState


class Situation(eqx.Module):
    """What the decision looks at, all as odometry sees it.

    base: pose (x, y, yaw). station: pose it should take for what comes next. home: brush in the base frame
    where the arm works best (x, y [m]). brush: (x, y) of the reference [m]. heading: yaw of the reference's
    brush axis [rad]. speed: of the reference [m/s]. travelled: base travel of the last step [m].
    """

    base: Float[Array, "3"]
    station: Float[Array, "3"]
    home: Float[Array, "2"]
    brush: Float[Array, "2"]
    heading: Float[Array, ""]
    speed: Float[Array, ""]
    travelled: Float[Array, ""]


def demand_base(
    situation: Situation,
    wheel_angle: Float[Array, "w"],
    drive: AbstractDrive,
    speed_limit: Float[Array, "3"],
    state: HaltState,
    thresholds: Thresholds,
    settings: ControllerSettings,
    dt: Float[Array, ""],
) -> BaseDemand:
    """One decision: station, latch, speed, and whether the wheels are ready.

    With the low-speed rule off nothing is demanded, and the gate is the latch alone.
    """
    s, lever = situation, settings.yaw_lever
    offset = jnp.stack(
        [s.station[0] - s.base[0], s.station[1] - s.base[1], wrap(s.station[2] - s.base[2]) * lever]
    )
    left = _length(offset)
    ruled = (thresholds.low_speed_scale > 0).astype(left.dtype)
    arrived = (left < _ARRIVED).astype(left.dtype) * ruled
    worthwhile = jnp.maximum((left >= _WORTH_A_START).astype(left.dtype), 1 - ruled)
    far = stretch(s.base, s.brush, s.heading, s.home, lever)
    halt = update_halt(state, s.travelled, far, arrived, worthwhile, thresholds, dt)
    free = 1 - halt.halted
    pace = (
        jnp.clip(_APPROACH * left, _LEAST, jnp.maximum(thresholds.low_speed_scale * s.speed, _LEAST)) * ruled
    )
    velocity = (
        pace
        * offset
        / jnp.maximum(left, 1e-6)
        / jnp.stack([jnp.ones_like(lever), jnp.ones_like(lever), lever])
    )
    velocity = (
        velocity
        * jnp.minimum(1.0, 1 / jnp.maximum((jnp.abs(velocity) / speed_limit).max(), 1e-9))
        * (1 - arrived)
    )
    ready = drive.readiness(body_twist(velocity, s.base[2]), wheel_angle)
    return BaseDemand(velocity, free * jnp.where(ruled > 0, ready, 1.0), free, halt)


def body_twist(velocity: Float[Array, "3"], yaw: Float[Array, ""]) -> Float[Array, "3"]:
    """A base velocity in the map frame as twist in the base frame, S1-(8)."""
    c, s = jnp.cos(yaw), jnp.sin(yaw)
    return jnp.stack([c * velocity[0] + s * velocity[1], c * velocity[1] - s * velocity[0], velocity[2]])


def stretch(
    base: Float[Array, "3"], brush: Float[Array, "2"], heading, home: Float[Array, "2"], lever
) -> Float[Array, ""]:
    """How far the brush is from its best place before the arm [m]: the reach margin's measure.

    base: (x, y, yaw). brush: (x, y) [m], heading: yaw of its axis [rad]. home: the best place in the base
    frame.
    """
    ahead = body_twist(jnp.stack([brush[0] - base[0], brush[1] - base[1], heading]), base[2])
    turn = wrap(heading - base[2]) * lever
    return _length(jnp.stack([ahead[0] - home[0], ahead[1] - home[1], turn]))


def _length(vector: Float[Array, "n"]) -> Float[Array, ""]:
    return jnp.sqrt((vector**2).sum() + 1e-12)
