"""From where the scan ended to the first stroke."""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from jaxpaint.compiling import batched, one_by_one
from jaxpaint.kinematics.ik import IKSettings, solve, spread_starts
from jaxpaint.kinematics.pose import Pose
from jaxpaint.trajectories import Trajectory, clearance
from opt.wbc.base_motion import stretch
from sims.painting.drive import JointPlan
from sims.painting.job import Job
from sims.painting.motion import motion_duration, motion_rows, plan_motion
from sims.painting.path import Painting
from sims.painting.scan import joint_plan
from sims.worlds import World

_STARTS = 6
# The spin about the brush is free, as for the whole-body controller; a little weight keeps the camera
# upright.
_SPIN = 0.3


class Approach(NamedTuple):
    """The motion to the first stroke, whether it can be reached, and the least gap to the scanned surface
    [m].
    """

    plan: JointPlan
    reachable: Bool[Array, ""]
    gap: Float[Array, ""]


def plan_approach(job: Job, world: World, row: Float[Array, "19"], station: Float[Array, "3"]):
    """Trajectory from the world's present (believed) posture to the brush pose of `row`.

    The base stays where it is if the first stroke is within the release margin there, else it drives to
    `station`.
    """
    axis = row[5:12:3]
    heading = jnp.arctan2(axis[1], axis[0])
    far = stretch(world.odometry, row[:2], heading, job.limits.home, job.settings.yaw_lever)
    base = jnp.where(far <= job.thresholds.release_margin, world.odometry, station)
    target = Pose(row[:3], row[3:12].reshape(3, 3))
    spread = spread_starts(job.robot.home, job.robot.lower, job.robot.upper, count=_STARTS)
    starts = jnp.concatenate([job.robot.home[None], world.arm[None], spread[1:]])
    settings = IKSettings(spin_weight=_SPIN, position_tolerance=1e-3, orientation_tolerance=0.02)
    found = solve(job.robot.arm(base), starts, target, job.robot.lower, job.robot.upper, settings)
    here = jnp.concatenate([world.odometry, world.arm])
    waypoints = jnp.stack([here, jnp.concatenate([base, found.q])])
    trajectory = plan_motion(job, waypoints, jnp.ones(2, bool))
    return trajectory, motion_duration(trajectory), found.converged


def gap_to_surface(job: Job, trajectory: Trajectory, obstacles: Float[Array, "m 3"]) -> Float[Array, ""]:
    """Least gap between the body and the scanned points on the way [m]."""
    coarse = motion_rows(trajectory, motion_duration(trajectory) / 24, 25)[:, :9]
    real = jnp.isfinite(obstacles).all(-1)
    points = jnp.where(real[:, None], obstacles, 1e3)

    def distance(p):
        return jnp.sqrt(((points - p) ** 2).sum(-1).min())

    return clearance(job.robot.chain, job.robot.spheres, coarse, distance).min()


_PLAN = batched(plan_approach, in_axes=(None, 0, 0, 0))
_GAP = one_by_one(gap_to_surface, in_axes=(None, 0, 0))


def approach(job: Job, worlds: World, painting: Painting) -> Approach:
    """Plans the approach in all worlds."""
    trajectory, duration, reachable = _PLAN(
        job, worlds, painting.plan.rows[:, 0], painting.plan.stations[:, 0]
    )
    gap = _GAP(job, trajectory, painting.obstacles)
    return Approach(joint_plan(job, trajectory, duration), reachable, gap)


def body_is_clear(gap: Float[Array, " worlds"]) -> np.ndarray:
    """Whether nothing touched."""
    return np.asarray(gap) >= 0
