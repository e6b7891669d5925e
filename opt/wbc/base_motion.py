"""Where the base should go and how fast: the station, the latch S1-(13) and the speed S1-(12)."""

from typing import NamedTuple

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.decisions.halting import HaltState, update_halt
from jaxpaint.decisions.thresholds import Thresholds
from jaxpaint.steering import AbstractDrive, wrap
from opt.wbc.limits.low_speed import is_signed
from opt.wbc.polar import polar_twist
from opt.wbc.settings import ControllerSettings

# Further than any margin of reach [m].
_ANYWHERE = 1e3


class BaseDemand(NamedTuple):
    """velocity: demanded base velocity in the map frame (x, y [m/s], yaw [rad/s]). gate: 1 where the base may
    move. steer: 1 while the wheels should turn towards the demand. halt: the latch. waits: 1 while the plan
    waits for the base. left: way to the station, with yaw times its lever [m].
    """

    velocity: Float[Array, "3"]
    gate: Float[Array, ""]
    steer: Float[Array, ""]
    halt: HaltState
    waits: Float[Array, ""]
    left: Float[Array, ""]


class Situation(eqx.Module):
    """What the decision looks at, all as odometry sees it.

    base: pose (x, y, yaw). station: pose it should take for what comes next. home: brush in the base frame
    where the arm works best (x, y [m]). brush: (x, y) of the reference [m]. heading: yaw of the reference's
    brush axis [rad]. pen: 1 while it is down. speed: of the reference [m/s]. travelled: base travel of the
    last step [m].
    """

    base: Float[Array, "3"]
    station: Float[Array, "3"]
    home: Float[Array, "2"]
    brush: Float[Array, "2"]
    heading: Float[Array, ""]
    pen: Float[Array, ""]
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

    With the low-speed rule off or as printed nothing is demanded, and the gate is the latch alone. A base
    that parks is let go by the pen, whatever the reach and the way, and stays while the pen is down; without
    stations, where the rule is off or as printed, it cannot park.
    """
    s, lever = situation, settings.yaw_lever
    offset = jnp.stack(
        [s.station[0] - s.base[0], s.station[1] - s.base[1], wrap(s.station[2] - s.base[2]) * lever]
    )
    left = _length(offset)
    signed = is_signed(thresholds).astype(left.dtype)
    arrived = (left < settings.base_arrived).astype(left.dtype) * signed
    parks, down = (thresholds.park > 0) & (signed > 0), s.pen > 0.5
    worthwhile = jnp.maximum((left >= settings.base_worthwhile).astype(left.dtype), 1 - signed)
    worthwhile = jnp.where(parks, 1.0 - down, worthwhile)
    far = jnp.where(parks, _ANYWHERE, stretch(s.base, s.brush, s.heading, s.home, lever))
    stay = jnp.maximum(arrived, parks & down)
    halt = update_halt(state, s.travelled, far, stay, worthwhile, thresholds, dt)
    free = 1 - halt.halted
    gain, least = settings.base_approach, settings.base_least_speed
    fastest = jnp.maximum(thresholds.low_speed_scale * s.speed, least)
    if drive.nonholonomic_rows.shape[0]:
        row = drive.nonholonomic_rows[0]
        twist = polar_twist(s.base, s.station, row, lever, gain, (least, fastest))
        velocity = map_velocity(twist, s.base[2]) * signed
    else:
        velocity = _straight(offset, left, jnp.clip(gain * left, least, fastest) * signed, lever)
    most = (jnp.abs(velocity) / jnp.maximum(speed_limit, 1e-9)).max()
    share = 1 / jnp.maximum(most, 1.0)
    velocity = velocity * share * (1 - arrived)
    ready = drive.readiness(body_twist(velocity, s.base[2]), wheel_angle)
    waits = (parks & ~down) * (1 - arrived)
    return BaseDemand(velocity, free * jnp.where(signed > 0, ready, 1.0), free, halt, waits, left)


def base_at_rest(state: HaltState) -> BaseDemand:
    """The decision of an arm that has no base: halted for ever."""
    zero = jnp.zeros_like(state.halted)
    return BaseDemand(jnp.zeros_like(zero, shape=(3,)), zero, zero, state, zero, zero)


def _straight(offset: Float[Array, "3"], left, pace, lever) -> Float[Array, "3"]:
    """The velocity that makes up for x, y and yaw at once."""
    one = jnp.ones_like(lever)
    return pace * offset / jnp.maximum(left, 1e-6) / jnp.stack([one, one, lever])


def body_twist(velocity: Float[Array, "3"], yaw: Float[Array, ""]) -> Float[Array, "3"]:
    """A base velocity in the map frame as twist in the base frame, S1-(8)."""
    c, s = jnp.cos(yaw), jnp.sin(yaw)
    return jnp.stack([c * velocity[0] + s * velocity[1], c * velocity[1] - s * velocity[0], velocity[2]])


def map_velocity(twist: Float[Array, "3"], yaw: Float[Array, ""]) -> Float[Array, "3"]:
    """A base twist in the base frame as velocity in the map frame."""
    return body_twist(twist, -yaw)


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
