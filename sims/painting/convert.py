"""One controller's plan as the other's: what a forced or unexpected decision needs."""

import dataclasses

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from jaxpaint.compiling import batched
from jaxpaint.kinematics.chain import KinematicChain, jacobian
from sims.odometry import no_slip
from sims.painting.drive import BrushPlan, JointPlan, drive
from sims.painting.job import PAINT, Job
from sims.rollout import RECORD_EVERY, Record
from sims.worlds import Kinematic, World, standing

# Rows of the plan between base stations: half a second, as in `path`.
_STATION_EVERY = 25


def joints_for_brush(job: Job, plan: BrushPlan, worlds: World, index: Int[Array, " worlds"]) -> JointPlan:
    """A joint plan that paints the path: what the whole-body controller does where nothing slips.

    The robot plans with its model of itself, from what it believes of its posture.
    """
    return joints_of(job, ideal_run(job, plan, worlds, index))


def ideal_run(job: Job, plan: BrushPlan, worlds: World, index: Int[Array, " worlds"]) -> Record:
    """What a robot records that follows the path and never slips, from where the worlds' robots believe to
    stand.
    """
    still = jax.tree.map(jnp.zeros_like, job.noise.odometry)
    ideal = eqx.tree_at(lambda j: j.noise.odometry, dataclasses.replace(job, fidelity=Kinematic()), still)
    wheels = worlds.wheels.angle.shape[-1]
    believed = jax.vmap(lambda world: world.believed)(worlds)
    none = no_slip(wheels, believed.dtype)
    twin = jax.vmap(lambda base, arm: standing(base, arm, none, wheels))(believed, worlds.arm)
    return drive(ideal, plan, twin, index, PAINT).record


def joints_of(job: Job, record: Record) -> JointPlan:
    """A record's joints as a plan, on the time of the run."""
    q = np.concatenate([record.believed, record.arm], axis=-1)
    step = float(job.dt) * RECORD_EVERY
    speed = np.concatenate([np.diff(q, axis=1) / step, np.zeros_like(q[:, :1])], axis=1)
    rows = np.concatenate([q, speed, np.asarray(record.pen)[..., None]], axis=-1)
    length = (np.asarray(record.live).sum(axis=1) * step).astype(rows.dtype)
    return JointPlan(rows, np.full_like(length, step), 0 * length, length)


def _brush_row(chain: KinematicChain, row: Float[Array, "k"]) -> Float[Array, "19"]:
    pose, J = jacobian(chain, row[: chain.size])
    twist = (J * row[chain.size : 2 * chain.size]).sum(-1)
    return jnp.concatenate([pose.p, pose.R.reshape(-1), twist, jnp.zeros(1, row.dtype)])


_BRUSH_ROW = batched(_brush_row, in_axes=(None, 0), chunk=256)


def brush_for_joints(job: Job, plan: JointPlan) -> BrushPlan:
    """The brush path of a joint plan, pen up, with its base poses as stations."""
    worlds, count, width = plan.rows.shape
    rows = np.asarray(_BRUSH_ROW(job.robot.chain, np.asarray(plan.rows).reshape(-1, width))).reshape(
        worlds, count, -1
    )
    stations = np.asarray(plan.rows)[:, ::_STATION_EVERY, :3]
    return BrushPlan(
        rows, plan.step, plan.origin, stations, plan.step * _STATION_EVERY, plan.origin, plan.duration
    )
