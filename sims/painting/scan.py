"""Scanning the wall: viewpoints, how the robot reaches them, and what it sees there (S1 section II)."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from jaxpaint.compiling import batched, one_by_one
from jaxpaint.kinematics.chain import arm_chain, forward
from jaxpaint.kinematics.ik import spread_starts
from jaxpaint.kinematics.pose import Pose
from sims.odometry import draw_slip
from sims.painting.drive import Driven, JointPlan
from sims.painting.job import DEPTH, SLIP, START, Job
from sims.painting.motion import SETTLE, clear_motion, motion_duration, motion_rows
from sims.painting.postures import solve_apart
from sims.sensors import crop_to_canvas, merge_views, observe, render, thin
from sims.truth import true_camera
from sims.worlds import World, standing

# Points of a world's merged cloud: a static budget.
MAX_POINTS = 40_000
# Plans are filled up to a multiple of so many rows, so that few sizes are ever compiled.
PLAN_ROWS = 500
# Starts of the inverse kinematics beside the last posture and the planned one: home and postures about it, as
# one start alone can end in a local minimum.
_STARTS = 6


class ScanPlan(NamedTuple):
    """The motion through all viewpoints: its plan, when the camera looks [s], whether every view can be
    reached, and the least gap between the body and the lidar's echoes on the way [m].
    """

    plan: JointPlan
    look: Float[Array, " views"]
    reachable: Bool[Array, ""]
    gap: Float[Array, ""]


class View(NamedTuple):
    """Camera poses of one world's views: true and believed."""

    true: Pose
    believed: Pose


def starting_world(job: Job, index: Int[Array, ""]) -> World:
    """A robot near the first stop, at home, with this world's slip; odometry starts where it stands."""
    nominal = job.camera_base[0]
    offset = job.noise.start * jax.random.normal(job.key(index, START), (3,), nominal.dtype)
    slip = draw_slip(job.noise.odometry, job.limits.drive.size, key=job.key(index, SLIP))
    return standing(nominal + offset, job.robot.home, slip, job.limits.drive.size)


def plan_scan(job: Job, world: World) -> tuple[Float[Array, "w joints"], Bool[Array, ""]]:
    """Waypoints from the start through all views, and whether every view can be reached.

    The first stop is where the robot stands; for the others it drives.
    """
    spread = spread_starts(job.robot.home, job.robot.lower, job.robot.upper, count=_STARTS)

    def visit(q_before, view):
        place, rotation, stop, planned = view
        base = jnp.where((stop == job.camera_base[0]).all(), world.believed, stop)
        chain = arm_chain(job.robot.camera_chain, base)
        starts = jnp.concatenate([q_before[None], planned[None], spread])
        found = solve_apart(job.robot, chain, base, starts, Pose(place, rotation))
        return found.q, (jnp.concatenate([base, found.q]), found.converged)

    views = job.camera_place, job.camera_rotation, job.camera_base, job.camera_joints
    _, (stops, converged) = jax.lax.scan(visit, world.arm, views)
    here = jnp.concatenate([world.believed, world.arm])
    return jnp.concatenate([here[None], stops]), converged.all()


_WORLDS = batched(starting_world, in_axes=(None, 0))
_PLAN = batched(plan_scan, in_axes=(None, 0))


def _rows(job: Job, trajectory, count: Int[Array, " t"]) -> Float[Array, "t k"]:
    return motion_rows(trajectory, job.dt, count.shape[0])


_ROWS = one_by_one(_rows, in_axes=(None, 0, None))


def start_worlds(job: Job, index: np.ndarray) -> World:
    """The worlds of those indices."""
    return _WORLDS(job, jnp.asarray(index, jnp.int32))


def scan_motion(job: Job, worlds: World) -> ScanPlan:
    """Plans the scan in all worlds."""
    waypoints, reachable = _PLAN(job, worlds)
    unknown = np.full((len(waypoints), 1, 3), np.nan, waypoints.dtype)  # nothing is scanned yet
    motion = clear_motion(job, waypoints, unknown)
    duration = jax.vmap(motion_duration)(motion.trajectory)
    looks = motion.arrival[:, 1:] + SETTLE / 2
    reachable = reachable & motion.strong
    return ScanPlan(joint_plan(job, motion.trajectory, duration), looks, reachable, motion.gap)


def joint_plan(job: Job, trajectory, duration) -> JointPlan:
    """Trajectories of all worlds, sampled at the control period."""
    count = steps_for(job, duration)
    rows = np.asarray(_ROWS(job, trajectory, jnp.zeros(count, jnp.int32)))
    rows = np.concatenate([rows, np.zeros_like(rows[..., :1])], axis=-1)  # the pen is up
    step = np.full(len(rows), float(job.dt), rows.dtype)
    return JointPlan(rows, step, 0 * step, np.asarray(duration))


def steps_for(job: Job, duration, *, multiple: int = PLAN_ROWS) -> int:
    """Rows for the longest of the durations, rounded up."""
    longest = float(np.max(np.where(np.isfinite(duration), duration, 0.0)))
    return multiple * max(1, int(np.ceil((longest / float(job.dt) + 2) / multiple)))


def _views(
    job: Job,
    base: Float[Array, "views 3"],
    tilt: Float[Array, "views 3"],
    arm: Float[Array, "views arm"],
    believed: Float[Array, "views 3"],
) -> View:
    rows = range(base.shape[0])
    true = [true_camera(job.robot, job.calibration, base[k], tilt[k], arm[k]) for k in rows]
    taken = [forward(job.robot.camera_chain, jnp.concatenate([believed[k], arm[k]])) for k in rows]
    return View(*(Pose(jnp.stack([f.p for f in x]), jnp.stack([f.R for f in x])) for x in (true, taken)))


_VIEWS = batched(_views, in_axes=(None, 0, 0, 0, 0))


def _see(job: Job, view: View, index: Int[Array, ""]):
    """The cloud of one world, in the map frame as the robot believes it."""

    def look(pose, number):
        picture = render(job.scene, job.camera, pose.p, pose.R)
        key = jax.random.fold_in(job.key(index, DEPTH), number)
        return observe(picture, job.camera, job.noise.depth, key=key)

    pictures = jax.lax.map(lambda x: look(*x), (view.true, jnp.arange(job.camera_place.shape[0])))
    cloud, valid = merge_views(job.camera, pictures.depth, pictures.valid, view.believed.p, view.believed.R)
    valid = crop_to_canvas(cloud, valid, job.canvas)
    return thin(cloud, valid, MAX_POINTS)


_SEE = one_by_one(_see, in_axes=(None, 0, 0))


def see(job: Job, scan: ScanPlan, driven: Driven, index: np.ndarray):
    """Clouds [worlds, points, 3] and which points are real, from where the robot truly stood as it looked."""
    record = jax.tree.map(np.asarray, driven.record)
    reached = record.clock[:, None] >= np.asarray(scan.look)[..., None]
    row = np.where(reached.any(-1), reached.argmax(-1), record.clock.shape[1] - 1)[..., None]
    kept = record.base, record.tilt, record.arm, record.believed
    view = _VIEWS(job, *(jnp.asarray(np.take_along_axis(x, row, axis=1)) for x in kept))
    return _SEE(job, view, jnp.asarray(index, jnp.int32))
