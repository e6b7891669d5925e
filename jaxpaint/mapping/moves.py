"""Moves with the pen up: off the surface, over it, and down again."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from jaxpaint.mapping.planes import norm, unit
from jaxpaint.mapping.time_law import time_for, travelled

_FLATTEST = 0.1
"""Least share of the bump's top that is asked to clear an obstacle: the bump is zero at its ends."""

_SHARE = 0.5**0.5
"""Of the acceleration, for each of two motions at right angles."""


class MoveSettings(eqx.Module):
    """Numbers of the pen-up moves; all traced.

    clearance: lift along the normal [m]. margin: distance kept from the known surface on the way [m].
    corridor: half the width of the way in which the surface counts [m]. speed [m/s], acceleration [m/s^2],
    turn_rate [rad/s]: limits of the move.
    """

    clearance: Float[Array, ""] = eqx.field(default=0.05, converter=jnp.asarray)
    margin: Float[Array, ""] = eqx.field(default=0.03, converter=jnp.asarray)
    corridor: Float[Array, ""] = eqx.field(default=0.05, converter=jnp.asarray)
    speed: Float[Array, ""] = eqx.field(default=0.15, converter=jnp.asarray)
    acceleration: Float[Array, ""] = eqx.field(default=0.3, converter=jnp.asarray)
    turn_rate: Float[Array, ""] = eqx.field(default=0.5, converter=jnp.asarray)


class Move(eqx.Module):
    """A move between two points of the surface, in the map frame.

    start, end: points on the surface [m]. leave, arrive: unit normals there. bump: lift of the way's middle
    over the straight line [m]. length: the way's length for its time law [m]. rises, lowers: whether it
    starts and ends on the surface; where not, it starts or ends lifted.
    """

    start: Float[Array, "3"]
    end: Float[Array, "3"]
    leave: Float[Array, "3"]
    arrive: Float[Array, "3"]
    bump: Float[Array, "3"]
    length: Float[Array, ""]
    rises: Bool[Array, ""]
    lowers: Bool[Array, ""]


def plan_move(
    ends: tuple[Float[Array, "3"], Float[Array, "3"]],
    normals: tuple[Float[Array, "3"], Float[Array, "3"]],
    obstacles: Float[Array, "M 3"],
    counts: Bool[Array, "M"],
    settings: MoveSettings,
) -> Move:
    """The move over the straight line between two lifted points, with a bump where the surface needs it.

    The bump is a parabola along the mean normal. It follows the arc that turns from one normal to the other,
    as over a cylinder, and clears by the margin every point that counts in the corridor below the way.
    """
    start, end = ends
    leave, arrive = normals
    from_, to = start + settings.clearance * leave, end + settings.clearance * arrive
    up = unit(leave + arrive, otherwise=leave)
    straight = norm(to - from_)
    bulges = jnp.sum((end - start) * (arrive - leave)) > 0
    half = norm(arrive - leave) / jnp.maximum(norm(arrive + leave), 1e-2)
    arc = jnp.where(bulges, straight * half / (1 + jnp.sqrt(1 + half * half)) / 2, 0)
    height = jnp.maximum(arc, _needed(from_, to, up, obstacles, counts, settings))
    turning = 2 * half * settings.speed / settings.turn_rate
    steepest = jnp.maximum(norm(to - from_ + 4 * height * up), norm(to - from_ - 4 * height * up))
    length = jnp.maximum(jnp.maximum(steepest, turning), settings.clearance)
    yes = jnp.asarray(True)
    return Move(start, end, leave, arrive, height * up, length, yes, yes)


def _needed(from_, to, up, obstacles, counts, settings: MoveSettings) -> Float[Array, ""]:
    """Height of the bump that clears all points in the corridor [m]."""
    along = (to - from_) - jnp.sum((to - from_) * up) * up
    span = jnp.sum(along * along)
    share = jnp.sum((obstacles - from_) * along, axis=-1) / jnp.maximum(span, 1e-6)
    offset = obstacles - from_ - share[:, None] * (to - from_)
    above = jnp.sum(offset * up, axis=-1)
    aside = jnp.sum(offset * offset, axis=-1) - above * above
    below = counts & (share > 0) & (share < 1) & (aside < jnp.square(settings.corridor)) & (span > 1e-6)
    height = (above + settings.margin) / jnp.maximum(_bump(share), _FLATTEST)
    return jnp.max(jnp.where(below, height, 0), initial=0)


def move_time(move: Move, settings: MoveSettings) -> Float[Array, ""]:
    """Time of the move [s]."""
    lift, slide = _times(move, settings)
    return jnp.where(move.rises & move.lowers, lift + slide, lift)


def move_pose(
    move: Move, time: Float[Array, ""], settings: MoveSettings
) -> tuple[Float[Array, "3"], Float[Array, "3"]]:
    """Position [m] and unit normal at a time since the move's start [s]: twice continuously differentiable in
    time.

    The way over the surface starts when half of the lift's time is over, and the same before the end.
    """
    lift, slide = _times(move, settings)
    gentle = settings.acceleration * _SHARE
    whole = settings.clearance
    up = jnp.where(move.rises, travelled(time, whole, settings.speed, gentle), whole)
    starts = jnp.where(move.rises, slide, 0)
    down = jnp.where(move.lowers, travelled(time - starts, whole, settings.speed, gentle), 0)
    both = move.rises & move.lowers
    done = jnp.where(both, travelled(time - lift / 2, move.length, settings.speed, gentle), 0) / move.length
    normal = (1 - done) * move.leave + done * move.arrive
    line = (1 - done) * move.start + done * move.end
    return line + (up - down) * normal + _bump(done) * move.bump, unit(normal, otherwise=move.leave)


def _times(move: Move, settings: MoveSettings) -> tuple[Float[Array, ""], Float[Array, ""]]:
    """Time of the lift and of the way over the surface [s].

    The two overlap, each braking or starting at right angles to the other: each has 1 / sqrt(2) of the
    acceleration.
    """
    gentle = settings.acceleration * _SHARE
    return time_for(settings.clearance, settings.speed, gentle), time_for(move.length, settings.speed, gentle)


def _bump(share: Float[Array, "*n"]) -> Float[Array, "*n"]:
    return 4 * share * (1 - share)
