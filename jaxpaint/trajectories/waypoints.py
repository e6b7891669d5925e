"""Motion through waypoints with a rest at each: the trajectory controller's plan (S1 section IV-A)."""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from jaxpaint.trajectories.s_curve import SCurve, progress, s_curve, stretched


class State(eqx.Module):
    """Position, speed and acceleration of each joint: s(t) of S1 section IV-A [rad or m, and per second]."""

    p: Float[Array, " joints"]
    v: Float[Array, " joints"]
    a: Float[Array, " joints"]


class Limits(eqx.Module):
    """The most that each joint may do: speed, acceleration [rad or m, per second]."""

    speed: Float[Array, " joints"]
    acceleration: Float[Array, " joints"]


class Trajectory(eqx.Module):
    """Base and arm, each along its straight line from waypoint to waypoint, on one clock.

    points: the waypoints; those that were masked out repeat the one before. base, arm: progress of each along
    the segments, as shares of the way. start: when each segment begins [s]. rest: time at each waypoint [s].
    duration: to the end of the last rest [s].
    """

    points: Float[Array, "waypoints joints"]
    base: SCurve
    arm: SCurve
    start: Float[Array, " segments"]
    rest: Float[Array, " waypoints"]
    duration: Float[Array, ""]
    base_size: int = eqx.field(static=True)

    @property
    def segments(self) -> Float[Array, " segments"]:
        """How long each segment takes [s]; one without way takes no time."""
        return jnp.maximum(self.base.duration, self.arm.duration)

    @property
    def arrival(self) -> Float[Array, " waypoints"]:
        """When the robot has come to rest at each waypoint, the first included [s]."""
        return jnp.concatenate([jnp.zeros_like(self.start[:1]), self.start + self.segments])


def plan_base_and_arm(
    waypoints: Float[Array, "waypoints joints"],
    mask: Bool[Array, " waypoints"],
    limits: Limits,
    rest: float | Float[Array, " waypoints"] = 0.0,
    *,
    base_size: int = 3,
) -> Trajectory:
    """Base and arm planned apart, each as fast as it can, then put on one clock (S1's command adapter).

    Of each segment the faster of the two is slowed down, which keeps the limits, so that both arrive
    together. The base's first two joints are a position in the plane: their limits hold for its length,
    whatever the direction. The first waypoint is kept whatever its mask says: it is where one starts.
    """
    points = _forward_fill(waypoints, mask)
    ways = points[1:] - points[:-1]
    base = jax.vmap(lambda way: _fastest(*_line(way[:base_size], limits)))(ways)
    arm = jax.vmap(
        lambda way: _fastest(way[base_size:], limits.speed[base_size:], limits.acceleration[base_size:])
    )(ways)
    kept = mask | (jnp.arange(mask.shape[0]) == 0)
    rest = jnp.where(kept, jnp.broadcast_to(jnp.asarray(rest, points.dtype), mask.shape), 0)
    return on_one_clock(points, base, arm, rest, base_size)


def slowed(trajectory: Trajectory, factor: Float[Array, " segments"]) -> Trajectory:
    """The same with each segment in `factor` times the time; rests stay as they are."""
    t = trajectory
    return on_one_clock(t.points, stretched(t.base, factor), stretched(t.arm, factor), t.rest, t.base_size)


def sample(trajectory: Trajectory, t: Float[Array, ""]) -> State:
    """The state at time t [s]; at rest at either end before and after."""
    # the last segment that has begun and takes time; a maximum, since searching does not vectorise
    index = jnp.arange(trajectory.start.shape[0])
    segment = jnp.where((trajectory.start <= t) & (trajectory.segments > 0), index, 0).max()
    return on_segment(trajectory, segment, t - trajectory.start[segment])


def on_segment(trajectory: Trajectory, segment, time: Float[Array, ""]) -> State:
    """The state at a time since a segment's start [s]."""
    here, there = trajectory.points[segment], trajectory.points[segment + 1]
    way, size = there - here, trajectory.base_size
    base, arm = (
        progress(jax.tree.map(lambda leaf: leaf[segment], curve), time)
        for curve in (trajectory.base, trajectory.arm)
    )

    def joints(b, a):
        return jnp.concatenate([b * way[:size], a * way[size:]])

    return State(here + joints(base[0], arm[0]), joints(base[1], arm[1]), joints(base[2], arm[2]))


def _forward_fill(waypoints, mask):
    """Each waypoint, or the last kept one before it; what a masked one holds, NaN included, is ignored."""

    def keep(last, row):
        point, kept = row
        out = jnp.where(kept, point, last)
        return out, out

    _, filled = jax.lax.scan(keep, waypoints[0], (waypoints[1:], mask[1:]))
    return jnp.concatenate([waypoints[:1], filled])


def _line(way, limits: Limits):
    """The base's way as its length and turn, with the limits of each."""
    square = (way[:2] * way[:2]).sum()
    safe = jnp.where(square > 0, square, 1)
    length = jnp.where(square > 0, jnp.sqrt(safe), 0)
    size = way.shape[0]

    def least(limit):
        return jnp.concatenate([jnp.minimum(limit[0], limit[1])[None], limit[2:size]])

    return jnp.concatenate([length[None], way[2:]]), least(limits.speed), least(limits.acceleration)


def _fastest(way, speed, acceleration) -> SCurve:
    """All joints of a straight line in step: the share of the way that is done."""
    away = jnp.abs(way)
    moves = away > 0
    safe = jnp.where(moves, away, 1)
    rate = jnp.where(moves, speed / safe, jnp.inf).min()
    gain = jnp.where(moves, acceleration / safe, jnp.inf).min()
    some = moves.any()
    one = jnp.ones_like(rate)
    return s_curve(jnp.where(some, one, 0), jnp.where(some, rate, one), jnp.where(some, gain, one))


def on_one_clock(
    points: Float[Array, "waypoints joints"],
    base: SCurve,
    arm: SCurve,
    rest: Float[Array, " waypoints"],
    base_size: int,
) -> Trajectory:
    """Segments of base and arm (progress as shares of the way), the faster slowed down to the other, in a row
    with a rest [s] at each waypoint.
    """
    both = jnp.maximum(base.duration, arm.duration)

    def to_both(curve: SCurve) -> SCurve:
        moves = curve.duration > 0
        return stretched(curve, jnp.where(moves, both / jnp.where(moves, curve.duration, 1), 1))

    base, arm = to_both(base), to_both(arm)
    begin = rest[0] + jnp.cumsum(both + rest[1:]) - (both + rest[1:])
    return Trajectory(points, base, arm, begin, rest, rest.sum() + both.sum(), base_size)
