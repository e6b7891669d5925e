"""Waypoints for base and arm as a plan on one clock, with a rest at each: for the trajectory controller."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from jaxpaint.trajectories import Trajectory, plan_base_and_arm, sample
from sims.painting.job import Job

# Share of the robot's limits that positioning moves use: they are not what a run's time is spent on.
_PACE = 0.5
# Rest at each waypoint [s]: the camera looks, the base has stopped.
SETTLE = 0.6


def plan_motion(job: Job, waypoints: Float[Array, "w 9"], mask: Bool[Array, " w"]) -> Trajectory:
    """Straight base lines and joint-space quintics within velocity and acceleration limits."""
    limit, acceleration = job.robot.speed_limit * _PACE, job.robot.acceleration_limit * _PACE
    return plan_base_and_arm(waypoints, mask, limit, acceleration, base_size=job.robot.base_size)


def rest_times(trajectory: Trajectory) -> Float[Array, " w"]:
    """When the robot has come to rest at each waypoint, the first included [s]."""
    number = jnp.arange(trajectory.start.shape[0])
    return trajectory.start + number * SETTLE


def motion_duration(trajectory: Trajectory) -> Float[Array, ""]:
    """From the first waypoint to the end of the rest at the last [s]."""
    return rest_times(trajectory)[-1] + SETTLE


def motion_rows(trajectory: Trajectory, step: Float[Array, ""], count: int) -> Float[Array, "t 18"]:
    """Positions and velocities at `count` steps from zero; at rest after the end."""
    segments = trajectory.segments
    begin = rest_times(trajectory)[:-1] + SETTLE

    def row(time):
        moved = jnp.clip(time - begin, 0.0, segments)
        state = sample(trajectory, moved.sum())
        moving = ((time >= begin) & (time < begin + segments)).any()
        return jnp.concatenate([state.p, jnp.where(moving, state.v, 0.0)])

    return jax.vmap(row)(jnp.arange(count) * step)
