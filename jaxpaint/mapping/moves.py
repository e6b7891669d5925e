"""Moves with the pen up: off the surface, over it, and down again."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from jaxpaint.mapping.planes import norm, unit
from jaxpaint.mapping.time_law import time_for, travelled

_FLATTEST = 0.1
"""Least share of the bump's top that is asked to clear an obstacle, on ways that are metres long."""

_STEEPEST = 4.0, 8.0
"""Slope of parabola and quartic at their ends, for a top of one, on a way of one."""

_SHARE = 0.5**0.5
"""Of the acceleration, for each of two motions at right angles."""


CHANGE_TIME = 10.0
"""Time that a change of the tool takes [s]: a guess of what a person with the next brush at hand needs."""


class MoveSettings(eqx.Module):
    """Numbers of the pen-up moves; all traced.

    clearance: lift along the normal [m]. low: the same for a hop to a neighbour, and slope: how much more for
    each metre to go, up to the clearance [-]. margin: distance kept from the known surface on the way [m].
    corridor: half the width of the way in which the surface counts [m]. speed [m/s], acceleration [m/s^2],
    turn_rate [rad/s]: limits of the move. change_height: lift for another tool [m]: room for a hand or a tool
    holder between brush and wall, within the arm's reach back from it. change_time: that the change takes
    [s].
    """

    clearance: Float[Array, ""] = eqx.field(default=0.05, converter=jnp.asarray)
    low: Float[Array, ""] = eqx.field(default=0.025, converter=jnp.asarray)
    slope: Float[Array, ""] = eqx.field(default=0.5, converter=jnp.asarray)
    margin: Float[Array, ""] = eqx.field(default=0.03, converter=jnp.asarray)
    corridor: Float[Array, ""] = eqx.field(default=0.05, converter=jnp.asarray)
    speed: Float[Array, ""] = eqx.field(default=0.25, converter=jnp.asarray)
    acceleration: Float[Array, ""] = eqx.field(default=1.0, converter=jnp.asarray)
    turn_rate: Float[Array, ""] = eqx.field(default=0.8, converter=jnp.asarray)
    change_height: Float[Array, ""] = eqx.field(default=0.25, converter=jnp.asarray)
    change_time: Float[Array, ""] = eqx.field(default=CHANGE_TIME, converter=jnp.asarray)


class Move(eqx.Module):
    """A move between two points of the surface, in the map frame.

    start, end: points on the surface [m]. leave, arrive: unit normals there. lift: height of the straight
    line over them [m]. bump: lift of the way's middle over that line [m]. broad: whether the bump has
    shoulders. length: the way's length for its time law [m]. rises, lowers: whether it starts and ends on the
    surface; where not, it starts or ends lifted. changes: whether the tool is changed, at the top before the
    way over the surface.
    """

    start: Float[Array, "3"]
    end: Float[Array, "3"]
    leave: Float[Array, "3"]
    arrive: Float[Array, "3"]
    lift: Float[Array, ""]
    bump: Float[Array, "3"]
    broad: Bool[Array, ""]
    length: Float[Array, ""]
    rises: Bool[Array, ""]
    lowers: Bool[Array, ""]
    changes: Bool[Array, ""]


def plan_move(
    ends: tuple[Float[Array, "3"], Float[Array, "3"]],
    normals: tuple[Float[Array, "3"], Float[Array, "3"]],
    obstacles: Float[Array, "M 3"],
    counts: Bool[Array, "M"],
    settings: MoveSettings,
    *,
    on_surface: tuple[Bool[Array, ""], Bool[Array, ""]],
    changes: Bool[Array, ""],
) -> Move:
    """The move over the straight line between two lifted points, with a bump where the surface needs it.

    The bump goes along the mean normal. It follows the arc that turns from one normal to the other, as over a
    cylinder, and clears by the margin every point that counts in the corridor below the way. It is a
    parabola; over what is near an end that must be several times as high, and where the broad shoulders of
    a quartic need less by more than the clearance it is one, or an arm would have to fold up. on_surface:
    whether it starts and ends there.
    """
    start, end = ends
    leave, arrive = normals
    rises, lowers = on_surface
    lift = _lift(norm(end - start), rises & lowers, changes, settings)
    from_, to = start + lift * leave, end + lift * arrive
    up = unit(leave + arrive, otherwise=leave)
    straight = norm(to - from_)
    bulges = jnp.sum((end - start) * (arrive - leave)) > 0
    half = norm(arrive - leave) / jnp.maximum(norm(arrive + leave), 1e-2)
    arc = jnp.where(bulges, straight * half / (1 + jnp.sqrt(1 + half * half)) / 2, 0)
    margin = jnp.minimum(settings.margin, 0.6 * lift)  # a low hop clears what it hops over, not more
    needed = _needed(from_, to, up, obstacles, counts, margin, settings)
    heights = jnp.maximum(arc, needed)
    broad = heights[0] > heights[1] + settings.clearance
    bump = jnp.where(broad, heights[1], heights[0]) * up
    steep = jnp.where(broad, _STEEPEST[1], _STEEPEST[0]) * bump
    turning = 2 * half * settings.speed / settings.turn_rate
    steepest = jnp.maximum(norm(to - from_ + steep), norm(to - from_ - steep))
    length = jnp.maximum(jnp.maximum(steepest, turning), lift)
    return Move(start, end, leave, arrive, lift, bump, broad, length, rises, lowers, changes)


def _lift(distance, both, changes, settings: MoveSettings) -> Float[Array, ""]:
    """How high [m]: little for a hop to a neighbour, much for another tool."""
    hop = jnp.minimum(settings.low + settings.slope * distance, settings.clearance)
    usual = jnp.where(both, hop, settings.clearance)
    return jnp.where(changes, settings.change_height, usual)


def _needed(from_, to, up, obstacles, counts, margin, settings: MoveSettings) -> Float[Array, "2"]:
    """Height of either bump that clears all points in the corridor [m].

    A point nearer to an end than the margin counts as if it were so far from it: there the brush comes down
    along the normal, however high the bump is.
    """
    along = (to - from_) - jnp.sum((to - from_) * up) * up
    span = jnp.sum(along * along)
    share = jnp.sum((obstacles - from_) * along, axis=-1) / jnp.maximum(span, 1e-6)
    offset = obstacles - from_ - share[:, None] * (to - from_)
    above = jnp.sum(offset * up, axis=-1)
    aside = jnp.sum(offset * offset, axis=-1) - above * above
    below = counts & (share > 0) & (share < 1) & (aside < jnp.square(settings.corridor)) & (span > 1e-6)
    near = jnp.minimum(margin / jnp.sqrt(jnp.maximum(span, 1e-6)), 0.5)
    share = jnp.clip(share, near, 1 - near)
    shares = jnp.stack([_bump(share, jnp.asarray(broad)) for broad in (False, True)])
    height = (above + margin) / jnp.maximum(shares, _FLATTEST)
    return jnp.max(jnp.where(below, height, 0), axis=1, initial=0)


def move_time(move: Move, settings: MoveSettings) -> Float[Array, ""]:
    """Time of the move [s]."""
    lift, begin, slide = _times(move, settings)
    return jnp.where(move.rises & move.lowers, begin + slide + lift / 2, lift)


def lift_time(move: Move, settings: MoveSettings) -> Float[Array, ""]:
    """Time from the start of a move that rises to its top [s]: there, and not before, the tool is changed."""
    return _times(move, settings)[0]


def move_pose(
    move: Move, time: Float[Array, ""], settings: MoveSettings
) -> tuple[Float[Array, "3"], Float[Array, "3"]]:
    """Position [m] and unit normal at a time since the move's start [s]: twice continuously differentiable in
    time.

    The way over the surface starts when half of the lift's time is over, and the same before the end; for
    another tool it starts when that has been changed.
    """
    lift, begin, slide = _times(move, settings)
    both = move.rises & move.lowers
    gentle = settings.acceleration * _SHARE
    up = jnp.where(move.rises, travelled(time, move.lift, settings.speed, gentle), move.lift)
    starts = jnp.where(both, begin + slide - lift / 2, 0)
    down = jnp.where(move.lowers, travelled(time - starts, move.lift, settings.speed, gentle), 0)
    done = jnp.where(both, travelled(time - begin, move.length, settings.speed, gentle), 0) / move.length
    normal = (1 - done) * move.leave + done * move.arrive
    line = (1 - done) * move.start + done * move.end
    return line + (up - down) * normal + _bump(done, move.broad) * move.bump, unit(
        normal, otherwise=move.leave
    )


def _times(move: Move, settings: MoveSettings) -> tuple[Float[Array, ""], Float[Array, ""], Float[Array, ""]]:
    """Time of the lift, when the way over the surface starts, and its time [s].

    Lift and way overlap, each braking or starting at right angles to the other: each has 1 / sqrt(2) of the
    acceleration.
    """
    gentle = settings.acceleration * _SHARE
    lift = time_for(move.lift, settings.speed, gentle)
    begin = jnp.where(move.changes, lift + settings.change_time, lift / 2)
    return lift, begin, time_for(move.length, settings.speed, gentle)


def _bump(share: Float[Array, "*n"], broad: Bool[Array, ""]) -> Float[Array, "*n"]:
    side = jnp.square(2 * share - 1)
    return 1 - jnp.where(broad, side * side, side)
