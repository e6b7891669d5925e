"""Waypoints for base and arm as a plan on one clock, with a rest at each: for the trajectory controller."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from jaxpaint.trajectories import SCurve, Trajectory, on_one_clock, sample
from sims.painting.job import Job
from sims.painting.segments import BLOCK, Around, Segments, plan_segments, ways_around
from sims.painting.via_rests import via_rests
from sims.robots import Robot

# Rest at each waypoint [s]: the camera looks, the base has stopped, its wheels turn to where it goes next. At
# a via point there is only what its wheels need.
SETTLE = 0.6
# Wanted between the body and what is around it [m]: scanned points are centimetres apart, echoes are noisy.
_MARGIN = 0.03
# An end of the way that is nearer than that itself may be left by so much less [m].
_SLACK = 0.005


class Motion(NamedTuple):
    """trajectory: through all waypoints, with via points where the straight way touches. arrival: when the
    robot has come to rest at each waypoint [s]. gap: least gap of the robot on the way [m], a lower bound.
    strong: whether every motor can hold its links all the way.
    """

    trajectory: Trajectory
    arrival: Float[Array, "worlds w"]
    gap: Float[Array, " worlds"]
    strong: Bool[Array, " worlds"]

    @property
    def can_be_driven(self) -> Bool[np.ndarray, " worlds"]:
        """Whether nothing touches on the way and the motors can hold the robot."""
        return (np.asarray(self.gap) > 0) & np.asarray(self.strong)


def clear_motion(
    job: Job,
    waypoints: Float[Array | np.ndarray, "worlds w joints"],
    points: Float[Array | np.ndarray, "worlds m 3"],
) -> Motion:
    """`motion_among` what a job's lidar saw, with one cloud for all legs; the brush touches nowhere."""
    shape = np.shape(waypoints)[:2]
    legs = np.broadcast_to(np.asarray(points)[:, None], (shape[0], shape[1] - 1, *np.shape(points)[1:]))
    return motion_among(Around.of(job), waypoints, legs, np.zeros(shape, bool))


def motion_among(
    around: Around,
    waypoints: Float[Array | np.ndarray, "worlds w joints"],
    points: Float[np.ndarray, "worlds legs m 3"],
    touches: Bool[np.ndarray, "worlds w"],
) -> Motion:
    """The motion through the waypoints of every world, clear of the lidar's echoes, of itself and of what was
    scanned before each leg [m] (NaN is no point), as far as there is a way.

    touches: where the brush is at the wall: it counts everywhere but on the straight way to and from there.
    Base and arm go apart, in straight lines, as fast as speed, acceleration and torque limits allow.
    """
    waypoints = np.asarray(waypoints)
    worlds, _, joints = waypoints.shape
    ends = np.stack([waypoints[:, :-1], waypoints[:, 1:]], axis=2).reshape(-1, 2, joints)
    at = np.stack([touches[:, :-1], touches[:, 1:]], axis=2).reshape(-1, 2)
    chains = find_ways(around, ends, points.reshape(-1, *points.shape[2:]), at)
    by_world = jax.tree.map(lambda x: x.reshape(worlds, -1, *x.shape[2:]), chains)
    parts = chains.gap.shape[1]
    trajectory = _assembled(by_world, around.robot, parts)
    arrival = jax.vmap(lambda t: t.arrival)(trajectory)
    gap, strong = by_world.gap.min(axis=1), by_world.strong.all(axis=1)
    return Motion(trajectory, arrival[:, ::parts], jnp.asarray(gap), jnp.asarray(strong))


def find_ways(
    around: Around,
    ends: Float[np.ndarray, "n 2 joints"],
    points: Float[np.ndarray, "n m 3"],
    touches: Bool[np.ndarray, "n 2"] | bool = False,
) -> Segments:
    """A chain of segments between each pair of ends: [n, segments, ...]; touches: see `motion_among`.

    Straight, which is a chain whose first segments have no way, where that is clear by as much as is wanted
    and within the motors' strength; else the first of the ways around that is, else that with the largest
    gap. As many ways at a time are looked at as fill a block, in their order, and none after one that will
    do. From an end that touches, or to it, there is no clear way: none is looked for.
    """
    touches = np.broadcast_to(touches, (len(ends), 2))
    straight = plan_segments(around, ends, points, touches)
    wanted = np.minimum(_MARGIN, straight.at_ends.min(axis=1) - _SLACK)
    open_ = np.flatnonzero(~(_room(straight) >= wanted) & (straight.at_ends.min(axis=1) > 0))
    ways = ways_around(around, ends[open_]) if open_.size else np.zeros((0, 0, 2, ends.shape[-1]))
    best, left = _as_chain(straight, ways.shape[2]), np.arange(open_.size)
    way = 0
    while left.size and way < ways.shape[1]:
        some = np.arange(way, min(way + max(1, BLOCK // (3 * left.size)), ways.shape[1]))
        rows = open_[left]
        tried = _chains(around, ends[rows], ways[left][:, some], points[rows], touches[rows])
        for k in range(some.size):
            one = jax.tree.map(lambda x, k=k: x[:, k], tried)
            best = _improved(best, one, rows, wanted[rows])
        left = left[~(_room(best, rows).min(axis=1) >= wanted[rows])]
        way += some.size
    return best


def motion_duration(trajectory: Trajectory) -> Float[Array, ""]:
    """From the first waypoint to the end of the rest at the last [s]."""
    return trajectory.duration


def motion_rows(trajectory: Trajectory, step: Float[Array, ""], count: int) -> Float[Array, "t row"]:
    """Positions and velocities at `count` steps from zero; at rest after the end."""

    def row(time):
        state = sample(trajectory, time)
        return jnp.concatenate([state.p, state.v])

    return jax.vmap(row)(jnp.arange(count) * step)


def _chains(
    around: Around,
    ends: Float[np.ndarray, "n 2 joints"],
    vias: Float[np.ndarray, "n ways v joints"],
    points: Float[np.ndarray, "n m 3"],
    touches: Bool[np.ndarray, "n 2"],
) -> Segments:
    """The segments from end over the vias to end, [n, ways, v + 1, ...]."""
    count, ways, v, joints = vias.shape
    first, last = (np.broadcast_to(ends[:, None, k, None], (count, ways, 1, joints)) for k in (0, 1))
    rows = np.concatenate([first, vias, last], axis=2)
    pairs = np.stack([rows[:, :, :-1], rows[:, :, 1:]], axis=3).reshape(-1, 2, joints)
    free = np.zeros((count, ways, v), bool)
    first, last = (np.broadcast_to(touches[:, None, k, None], (count, ways, 1)) for k in (0, 1))
    at = np.concatenate([first, free, last], axis=2)
    at = np.stack([at[:, :, :-1], at[:, :, 1:]], axis=3).reshape(-1, 2)
    found = plan_segments(around, pairs, np.repeat(points, ways * (v + 1), axis=0), at)
    return jax.tree.map(lambda x: x.reshape(count, ways, v + 1, *x.shape[1:]), found)


def _as_chain(straight: Segments, vias: int) -> Segments:
    """The same as the last segment of a chain whose others end where they start and take no time."""

    def with_none(x, none):
        return np.stack([*[none] * vias, x], axis=1)

    start = np.stack([straight.ends[:, 0]] * 2, axis=1)
    base, arm = (
        jax.tree.map(with_none, c, SCurve(0 * c.length, 0 * c.duration, c.ramp, c.build_up))
        for c in (straight.base, straight.arm)
    )
    first = np.stack([straight.at_ends[:, 0]] * 2, axis=1)
    return Segments(
        with_none(straight.ends, start),
        base,
        arm,
        with_none(straight.gap, straight.at_ends[:, 0]),
        with_none(straight.at_ends, first),
        with_none(straight.strong, np.ones_like(straight.strong)),
    )


def _room(segments: Segments, rows: np.ndarray | slice = slice(None)) -> np.ndarray:
    """The gap, and no room at all where a motor is too weak."""
    return np.where(segments.strong[rows], segments.gap[rows], -np.inf)


def _improved(best: Segments, tried: Segments, index: np.ndarray, wanted: np.ndarray) -> Segments:
    """What was tried in place of the rows of that index, where those will not do and it is better."""
    room = _room(best, index).min(axis=1)
    better = ~(room >= wanted) & (_room(tried).min(axis=1) > room)

    def put(old, new):
        out = old.copy()
        out[index[better]] = new[better]
        return out

    return jax.tree.map(put, best, tried)


def _assembled(segments: Segments, robot: Robot, parts: int) -> Trajectory:
    """All segments of each world on one clock, `parts` to a waypoint, a rest at each."""
    points = np.concatenate([segments.ends[:, :, 0], segments.ends[:, -1:, 1]], axis=1)
    duration = np.maximum(segments.base.duration, segments.arm.duration)
    rest = via_rests(robot, points, duration, parts, SETTLE).astype(points.dtype)
    size = robot.base_size
    clock = jax.vmap(lambda points, base, arm, rest: on_one_clock(points, base, arm, rest, size))
    return jax.tree.map(np.asarray, clock(points, segments.base, segments.arm, rest))
