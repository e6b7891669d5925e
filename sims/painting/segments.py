"""Straight segments of a motion: how base and arm drive them, and how near the body comes to what is there.

Every segment is planned apart, in blocks of one size, so that one compilation serves all motions.
"""

from collections.abc import Sequence
from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from jaxpaint.compiling import Batched, batched, one_by_one
from jaxpaint.kinematics import Spheres
from jaxpaint.mapping.canvas import Canvas
from jaxpaint.planning.surroundings import CLUTTER, is_clutter, seen_over
from jaxpaint.trajectories import (
    Limits,
    Obstacles,
    SCurve,
    detours,
    footprint_gap,
    gap_on_the_way,
    on_one_clock,
    on_segment,
    own_gap,
    plan_within_torque,
)
from sims.painting.job import Job
from sims.robots import Robot

# Share of the robot's limits that plans use: the rest is for the feedback.
_PACE = 0.97
# Top of a wall's echo: above all that a robot reaches [m].
_AT_ALL_HEIGHTS = 1e3
# Moments of a segment at which its gap is looked at, and that of the robot to itself, whose links swing past
# each other faster than past the wall. The bound holds between them, and is close with so many.
_MOMENTS, _OWN_MOMENTS = 64, 256
# The robot's own shape is known to the millimetre, what is around it to centimetres: the gap to itself counts
# so many times.
_OWN_TIMES = 3.0
# A run begins where the brush at home is nearly at the wall. Where a way begins with the brush nearer than
# this, it counts as if it were so far away there, and may come no nearer on the way; by so much at most,
# which is what echoes are noisy by and its spheres stand out [m].
_BRUSH_ROOM, _BRUSH_SLACK = 0.01, 0.04
# What does not count is so much smaller than it is [m].
_NOT_THERE = 1e3
BLOCK = 32
"""Rows of a block: one compilation for all counts."""

# Scanned points are filled up to a multiple of this, for the same reason.
_POINTS = 512


class Around(eqx.Module):
    """Who moves and what the lidar saw: all of a job that planning a motion needs, so that other walls do not
    compile it again.
    """

    robot: Robot
    canvas: Canvas
    echoes: Float[Array, "beams 2"]

    @staticmethod
    def of(job: Job) -> "Around":
        """A job's."""
        return Around(job.robot, job.canvas, job.echoes)


class Segments(NamedTuple):
    """Straight ways and how they are done; the leading axis is the segments.

    ends: joint positions. base, arm: progress of each. gap: least gap of the robot on the way [m], a lower
    bound. at_ends: the gap at either end [m]. strong: whether every motor can hold its links on the way.
    """

    ends: Float[np.ndarray, "n 2 joints"]
    base: SCurve
    arm: SCurve
    gap: Float[np.ndarray, " n"]
    at_ends: Float[np.ndarray, "n 2"]
    strong: Bool[np.ndarray, " n"]


def limits(robot: Robot) -> Limits:
    """What plans may ask of the joints."""
    return Limits(robot.speed_limit * _PACE, robot.acceleration_limit * _PACE)


def plan_segments(
    around: Around,
    ends: Float[np.ndarray, "n 2 joints"],
    points: Float[np.ndarray, "n m 3"],
    touches: Bool[np.ndarray, "n 2"],
) -> Segments:
    """Each as fast as speed, acceleration and torque allow, with its gap to the points and to the echoes.

    touches: at which of the ends the brush is at the wall; on a way to or from there it does not count.
    """
    base, arm, strong = in_blocks(_DRIVE, (around.robot,), (ends,))
    brush = (~touches).all(axis=1).astype(ends.dtype)
    gap, at_ends = in_blocks(_GAP, (around,), (ends, base, arm, filled(points), brush))
    return Segments(ends, base, arm, gap, at_ends, strong > 0)


def ways_around(
    around: Around, ends: Float[np.ndarray, "n 2 joints"]
) -> Float[np.ndarray, "n ways v joints"]:
    """Via points of the ways that can be tried between the ends."""
    return in_blocks(_WAYS, (around.robot,), (ends,))


def surroundings(around: Around, points: Float[Array, "m 3"]) -> Obstacles:
    """Scanned points, and what the lidar saw: walls are upright, so their echoes stand for all heights,
    clutter for its own and below. Which is which is the planner of views' rule too; over what the camera saw
    something further back, nothing stands either.
    """
    canvas = around.canvas
    low = is_clutter(around.echoes, canvas.center[:2], canvas.ray[:2], canvas.size[0])
    lidar = around.robot.T_base_lidar.p[2]
    over = seen_over(around.echoes, points, canvas.ray[:2])
    high = jnp.minimum(jnp.where(low, lidar + CLUTTER, _AT_ALL_HEIGHTS), jnp.maximum(over, lidar))
    return Obstacles.points(points) + Obstacles.sticks(around.echoes, high)


def body_gap(
    robot: Robot, there: Obstacles, q: Float[Array, "times joints"], slack: Float[Array, ""]
) -> Float[Array, ""]:
    """A lower bound of the robot's gap [m] to what is there, at and between joint positions.

    The base counts as its rectangle, from the floor up to the lidar; all else as spheres, and what the base
    carries must also stay above the floor. slack: what the brush may be nearer [m].
    """
    whole = robot.body_and_brush
    is_brush = np.arange(whole.radius.shape[0]) >= robot.spheres.radius.shape[0]
    body = _thinner(whole, jnp.where(is_brush, slack, 0))
    gap = gap_on_the_way(robot.chain, body, q, there.distance)
    carried = _thinner(body, jnp.where(body.frame >= robot.base_size, 0, _NOT_THERE))
    floor = gap_on_the_way(robot.chain, carried, q, lambda p: p[2])
    base = footprint_gap(robot.footprint, q[:, : robot.base_size], there, robot.T_base_lidar.p[2])
    return jnp.minimum(jnp.minimum(gap, floor), base)


def _thinner(spheres: Spheres, by: Float[Array, " spheres"]) -> Spheres:
    return Spheres(spheres.frame, spheres.center, spheres.radius - by)


def filled(points: Float[np.ndarray, "n m 3"]) -> Float[np.ndarray, "n more 3"]:
    """With as many more that are no points as make the count a round one."""
    missing = -points.shape[1] % _POINTS
    return np.pad(np.asarray(points), ((0, 0), (0, missing), (0, 0)), constant_values=np.nan)


def in_blocks(program: Batched, shared: Sequence, rows: Sequence):
    """Runs a program on all rows, block by block; the last is filled up with rows of NaN."""
    rows = jax.tree.map(np.asarray, tuple(rows))
    count = len(jax.tree.leaves(rows)[0])
    blocks = []
    for first in range(0, count, BLOCK):
        part = jax.tree.map(lambda x, first=first: _block(x, first), rows)
        blocks.append(jax.tree.map(np.asarray, program(*shared, *part)))
    return jax.tree.map(lambda *parts: np.concatenate(parts)[:count], *blocks)


def _block(rows: np.ndarray, first: int) -> np.ndarray:
    own = rows[first : first + BLOCK]
    missing = [(0, BLOCK - len(own))] + [(0, 0)] * (own.ndim - 1)
    return np.pad(own, missing, constant_values=np.nan)


def _drive(robot: Robot, ends: Float[Array, "2 joints"]):
    """Progress of base and arm, and 1 where the motors are strong enough."""
    both = jnp.ones(2, bool)
    trajectory, strong = plan_within_torque(
        ends,
        both,
        limits(robot),
        0.0,
        robot.chain,
        robot.inertia,
        robot.torque_limit,
        base_size=robot.base_size,
    )
    return jax.tree.map(lambda x: x[0], (trajectory.base, trajectory.arm, strong.astype(ends.dtype)))


def _gap(around: Around, ends, base: SCurve, arm: SCurve, points, brush):
    """Least gap of one segment, and that at its ends; NaN, without work, for one that goes nowhere known."""
    known = jnp.isfinite(ends).all()
    nothing = jnp.full((), jnp.nan, ends.dtype), jnp.full(2, jnp.nan, ends.dtype)
    return jax.lax.cond(
        known, lambda: _known_gap(around, ends, base, arm, points, brush > 0), lambda: nothing
    )


def _known_gap(around: Around, ends, base: SCurve, arm: SCurve, points, brush):
    robot, there = around.robot, surroundings(around, points)
    base, arm = jax.tree.map(lambda x: x[None], (base, arm))
    segment = on_one_clock(ends, base, arm, jnp.zeros_like(ends[:, 0]), robot.base_size)

    def along(moments):
        times = jnp.linspace(0, 1, moments) * segment.segments[0]
        return jax.vmap(lambda time: on_segment(segment, 0, time).p)(times)

    def own(q):
        home = robot.at_home(q[0, :3])
        gap = own_gap(robot.chain, robot.body_and_brush, home, q, base_size=robot.base_size)
        return jnp.where(gap > 0, _OWN_TIMES, 1) * gap

    def brush_at(row):
        return gap_on_the_way(robot.chain, robot.brush, row[None], there.distance)

    slack = jnp.where(brush, jnp.clip(_BRUSH_ROOM - brush_at(ends[0]), 0, _BRUSH_SLACK), _NOT_THERE)

    def at(row):
        return jnp.minimum(body_gap(robot, there, row[None], slack), own(row[None]))

    at_ends = jax.lax.map(at, ends)
    gap = jnp.minimum(body_gap(robot, there, along(_MOMENTS), slack), own(along(_OWN_MOMENTS)))
    return jnp.minimum(gap, at_ends.min()), at_ends


def _ways(robot: Robot, ends):
    return detours(robot.chain, ends[0], ends[1], robot.lower, robot.upper, robot.home)


_DRIVE = batched(_drive, in_axes=(None, 0), chunk=BLOCK // 2)
_GAP = one_by_one(_gap, in_axes=(None, 0, 0, 0, 0, 0))
_WAYS = batched(_ways, in_axes=(None, 0), chunk=BLOCK // 2)
