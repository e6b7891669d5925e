"""Waypoints for base and arm as a plan on one clock, with a rest at each: for the trajectory controller."""

from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from jaxpaint.compiling import batched, one_by_one
from jaxpaint.mapping.canvas import Canvas
from jaxpaint.trajectories import (
    Limits,
    Obstacles,
    Trajectory,
    choose,
    detours,
    gap_on_the_way,
    plan_base_and_arm,
    plan_within_torque,
    sample,
)
from sims.painting.job import Job
from sims.robots import Robot

# Share of the robot's limits that plans use: the rest is for the feedback.
_PACE = 0.97
# Rest at each waypoint [s]: the camera looks, the base has stopped, its wheels turn to where it goes next.
SETTLE = 0.6
# Wanted between the body and what is around it [m]: scanned points are centimetres apart, echoes are noisy.
_MARGIN = 0.03
# An end of the way that is nearer than that itself may be left by so much less [m].
_SLACK = 0.005
# Moments of a way at which its gap is looked at.
_MOMENTS = 64
# What the lidar sees before the wall may be this much higher than its beams [m].
_CLUTTER = 0.25


class Motion(NamedTuple):
    """trajectory: through all waypoints, with via points where the straight way touches. arrival: when the
    robot has come to rest at each waypoint [s]. gap: least gap of the body on the way [m], a lower bound.
    """

    trajectory: Trajectory
    arrival: Float[Array, " w"]
    gap: Float[Array, ""]


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


def limits(robot: Robot) -> Limits:
    """What plans may ask of the joints."""
    return Limits(robot.speed_limit * _PACE, robot.acceleration_limit * _PACE)


def plan_motion(robot: Robot, waypoints: Float[Array, "w joints"], mask: Bool[Array, " w"]) -> Trajectory:
    """Base and arm apart, each in straight lines, as fast as speed, acceleration and torque limits allow."""
    return plan_within_torque(
        waypoints,
        mask,
        limits(robot),
        SETTLE,
        robot.chain,
        robot.inertia,
        robot.torque_limit,
        base_size=robot.base_size,
    )


def motion_duration(trajectory: Trajectory) -> Float[Array, ""]:
    """From the first waypoint to the end of the rest at the last [s]."""
    return trajectory.duration


def motion_rows(trajectory: Trajectory, step: Float[Array, ""], count: int) -> Float[Array, "t row"]:
    """Positions and velocities at `count` steps from zero; at rest after the end."""

    def row(time):
        state = sample(trajectory, time)
        return jnp.concatenate([state.p, state.v])

    return jax.vmap(row)(jnp.arange(count) * step)


def surroundings(around: Around, points: Float[Array, "m 3"]) -> Obstacles:
    """Scanned points, and what the lidar saw: walls are upright, so an echo behind the canvas stands for all
    heights, clutter before it for its own and below.
    """
    depth = around.canvas.to_canvas(
        jnp.concatenate([around.echoes, jnp.zeros_like(around.echoes[:, :1])], axis=1)
    )[1]
    lidar = around.robot.T_base_lidar.p[2]
    high = jnp.where(depth > 0, 1e3, lidar + _CLUTTER)
    return Obstacles.points(points) + Obstacles.sticks(around.echoes, high)


def clear_motion(
    job: Job,
    waypoints: Float[Array | np.ndarray, "worlds w joints"],
    points: Float[Array | np.ndarray, "worlds m 3"],
) -> Motion:
    """The motion through the waypoints of every world, clear of the points [m] (NaN is no point) and of the
    lidar's echoes as far as there is a way.
    """
    around = Around.of(job)
    gap, need = _STRAIGHT(around, waypoints, points)
    vias = jnp.repeat(waypoints[:, :-1, None], 2, axis=2)
    bent = jnp.zeros(gap.shape, bool)
    if not bool(np.all(np.asarray(gap >= need))):
        vias, bent = _BENT(around, waypoints, points, _WAYS(around, waypoints), need)
    trajectory, arrival = _PLAN(around, waypoints, vias, bent)
    return Motion(trajectory, arrival, _GAP(around, trajectory, points))


def _straight(around: Around, waypoints, points):
    """Gap of every straight segment, and how much there has to be."""
    there = surroundings(around, points)

    def at(q):
        return gap_on_the_way(around.robot.chain, around.robot.spheres, q[None], there.distance)

    ends = jax.lax.map(at, waypoints)
    need = jnp.minimum(_MARGIN, jnp.minimum(ends[1:], ends[:-1]) - _SLACK)
    pairs = jnp.stack([waypoints[:-1], waypoints[1:]], axis=1)
    gap = jax.lax.map(lambda pair: _gap_between(around.robot, there, pair), pairs)
    return gap, need


def _ways(around: Around, waypoints):
    robot = around.robot
    ends = waypoints[:-1], waypoints[1:]
    return jax.vmap(lambda a, b: detours(robot.chain, a, b, robot.lower, robot.upper))(*ends)


def _bent(around: Around, waypoints, points, ways, need):
    """Via points of every segment, and whether it has any."""
    there = surroundings(around, points)

    def segment(row):
        start, goal, ways, need = row
        vias, bent, _ = choose(start, goal, ways, lambda q: _gap_between(around.robot, there, q), need)
        return vias, bent

    return jax.lax.map(segment, (waypoints[:-1], waypoints[1:], ways, need))


def _plan(around: Around, waypoints, vias, bent):
    """The trajectory through waypoints and via points, and when it is at the waypoints."""
    rows = jnp.concatenate([waypoints[:-1, None], vias], axis=1).reshape(-1, waypoints.shape[1])
    kept = jnp.stack([jnp.ones_like(bent), bent, bent], axis=1).reshape(-1)
    trajectory = plan_motion(
        around.robot, jnp.concatenate([rows, waypoints[-1:]]), jnp.append(kept, jnp.ones_like(bent[:1]))
    )
    return trajectory, trajectory.arrival[::3]


def least_gap(around: Around, trajectory: Trajectory, points: Float[Array, "m 3"]) -> Float[Array, ""]:
    """The least gap between the body and what is around it on the way [m], a lower bound."""
    there = surroundings(around, points)
    count = trajectory.start.shape[0]

    def at(segment):
        start, long = trajectory.start[segment], trajectory.segments[segment]
        q = jax.vmap(lambda share: sample(trajectory, start + share * long).p)(jnp.linspace(0, 1, _MOMENTS))
        return gap_on_the_way(around.robot.chain, around.robot.spheres, q, there.distance)

    # a segment without way is not looked at twice
    moves = trajectory.segments > 0
    gap = jax.lax.map(
        lambda k: jax.lax.cond(moves[k], at, lambda k: jnp.full((), jnp.inf), k), jnp.arange(count)
    )
    here = gap_on_the_way(around.robot.chain, around.robot.spheres, trajectory.points[:1], there.distance)
    return jnp.minimum(gap.min(), here)


def _gap_between(robot: Robot, there: Obstacles, rows: Float[Array, "w joints"]):
    trajectory = plan_base_and_arm(
        rows, jnp.ones(rows.shape[0], bool), limits(robot), base_size=robot.base_size
    )
    times = jnp.linspace(0, 1, _MOMENTS) * trajectory.duration
    q = jax.vmap(lambda t: sample(trajectory, t).p)(times)
    return gap_on_the_way(robot.chain, robot.spheres, q, there.distance)


_STRAIGHT = one_by_one(_straight, in_axes=(None, 0, 0))
_WAYS = batched(_ways, in_axes=(None, 0))
_BENT = one_by_one(_bent, in_axes=(None, 0, 0, 0, 0))
_PLAN = batched(_plan, in_axes=(None, 0, 0, 0))
_GAP = one_by_one(least_gap, in_axes=(None, 0, 0))
