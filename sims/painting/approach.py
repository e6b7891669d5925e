"""From where the scan ended to the first stroke."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from jaxpaint.compiling import batched
from jaxpaint.kinematics.ik import IKSettings, solve, spread_starts
from jaxpaint.kinematics.pose import Pose
from opt.wbc.base_motion import stretch
from sims.painting.drive import JointPlan
from sims.painting.job import Job
from sims.painting.motion import clear_motion, motion_duration
from sims.painting.path import Painting
from sims.painting.scan import joint_plan
from sims.worlds import World

# Starts of the inverse kinematics: as for the scan.
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


def first_posture(job: Job, world: World, row: Float[Array, "19"], station: Float[Array, "3"]):
    """Waypoints from the world's present (believed) posture to the brush pose of `row`, and whether there is
    one.

    The base stays where it is if the first stroke is within the release margin and in the arm's reach there,
    else it drives to `station`.
    """
    axis = row[5:12:3]
    heading = jnp.arctan2(axis[1], axis[0])
    far = stretch(world.believed, row[:2], heading, job.limits.home, job.settings.yaw_lever)
    target = Pose(row[:3], row[3:12].reshape(3, 3))
    spread = spread_starts(job.robot.home, job.robot.lower, job.robot.upper, count=_STARTS)
    starts = jnp.concatenate([job.robot.home[None], world.arm[None], spread[1:]])
    settings = IKSettings(spin_weight=_SPIN, position_tolerance=1e-3, orientation_tolerance=0.02)

    def reach(base):
        return solve(job.robot.arm(base), starts, target, job.robot.lower, job.robot.upper, settings)

    bases = jnp.stack([world.believed, station])
    found = jax.vmap(reach)(bases)
    stay = (far <= job.thresholds.release_margin) & found.converged[0]
    base = jnp.where(stay, bases[0], bases[1])
    q, converged = jnp.where(stay, found.q[0], found.q[1]), stay | found.converged[1]
    here = jnp.concatenate([world.believed, world.arm])
    return jnp.stack([here, jnp.concatenate([base, q])]), converged


_POSTURE = batched(first_posture, in_axes=(None, 0, 0, 0))


def approach(job: Job, worlds: World, painting: Painting) -> Approach:
    """Plans the approach in all worlds, clear of what the camera and the lidar saw."""
    waypoints, reachable = _POSTURE(job, worlds, painting.plan.rows[:, 0], painting.plan.stations[:, 0])
    motion = clear_motion(job, waypoints, painting.obstacles)
    duration = jax.vmap(motion_duration)(motion.trajectory)
    return Approach(joint_plan(job, motion.trajectory, duration), reachable & motion.strong, motion.gap)


def body_is_clear(gap: Float[Array, " worlds"]) -> np.ndarray:
    """Whether nothing touched."""
    return np.asarray(gap) > 0
