"""Runs a plan in many worlds, block after block, until every world is done."""

import math
from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from jaxpaint.compiling import batched
from opt.plan import Samples
from opt.trajectory import TrajectoryController
from opt.wbc import WholeBodyController
from sims.painting.job import Job
from sims.painting.look import look
from sims.painting.marks import no_marks
from sims.robots.checks import check_goes_sideways
from sims.rollout import RECORD_EVERY, Record, RolloutState, run_block, start
from sims.worlds import World

# Control steps of a block: 8 s. Shorter wastes less on worlds that are done, longer calls less often.
_BLOCK = 400
# Rows of a plan that a block can need: its own steps, and what a controller looks ahead.
WINDOW = _BLOCK + 40
# A world may take this much longer than planned, waiting for the base, before it is given up.
_PATIENCE = 1.5
# Feedback of the trajectory controller [1/s]: errors die away in half a second, a twenty-fifth of what the
# control period would bear.
_TRAJECTORY_GAIN = 2.0


# Plans are cut on the host and followed on the devices.
Rows = Array | np.ndarray


class JointPlan(NamedTuple):
    """Rows of joint positions, their velocities and the pen every `step` [s], from `origin` [s]; and the
    duration [s].
    """

    rows: Float[Rows, "t k"]
    step: Float[Rows, ""]
    origin: Float[Rows, ""]
    duration: Float[Rows, ""]


class BrushPlan(NamedTuple):
    """Rows of `opt.wbc.Reference` every `step` [s] from `origin` [s], base stations every `station_step` [s]
    from `station_origin` [s], and the duration [s].
    """

    rows: Float[Rows, "t 19"]
    step: Float[Rows, ""]
    origin: Float[Rows, ""]
    stations: Float[Rows, "s 3"]
    station_step: Float[Rows, ""]
    station_origin: Float[Rows, ""]
    duration: Float[Rows, ""]


class Driven(NamedTuple):
    """States at the end and records of all worlds; records have axes [worlds, time].

    completed: the plan was followed to its end. diverged: a number was not finite, be it the plan's.
    """

    state: RolloutState
    record: Record
    completed: np.ndarray
    diverged: np.ndarray


def _trajectory(job: Job, plan: JointPlan) -> TrajectoryController:
    gain = jnp.asarray(_TRAJECTORY_GAIN, plan.rows.dtype)
    samples = Samples(plan.rows, plan.step, plan.origin)
    return TrajectoryController(chain=job.robot.chain, plan=samples, gain=gain, duration=plan.duration)


def _whole_body(job: Job, plan: BrushPlan) -> WholeBodyController:
    return WholeBodyController(
        robot=job.limits,
        settings=job.settings,
        thresholds=job.thresholds,
        reference=Samples(plan.rows, plan.step, plan.origin),
        stations=Samples(plan.stations, plan.station_step, plan.station_origin),
        speed=job.speed,
        pace=jnp.ones_like(job.dt),
        duration=plan.duration,
    )


def _starts(controller: Callable) -> Callable:
    return lambda job, plan, world: start(
        controller(job, plan), job.fidelity, world, no_marks(world.base.dtype)
    )


def _blocks(controller: Callable) -> Callable:
    def block(job: Job, plan, state: RolloutState, world: Int[Array, ""], number: Int[Array, "2"]):
        key = jax.random.fold_in(job.key(world, number[0]), number[1])
        following = controller(job, plan)
        return run_block(
            following,
            job.fidelity,
            job.limits,
            job.noise.odometry,
            job.dt,
            state,
            key,
            records=_BLOCK // RECORD_EVERY,
            look=lambda world, seen, clock, key: look(
                job, world, seen, following.surface(clock), clock, key=key
            ),
        )

    return block


_START = {
    JointPlan: batched(_starts(_trajectory), in_axes=(None, 0, 0)),
    BrushPlan: batched(_starts(_whole_body), in_axes=(None, 0, 0)),
}
_BLOCKS = {
    JointPlan: batched(_blocks(_trajectory), in_axes=(None, 0, 0, 0, None)),
    BrushPlan: batched(_blocks(_whole_body), in_axes=(None, 0, 0, 0, None)),
}


def drive(
    job: Job,
    plan: JointPlan | BrushPlan,
    worlds: World,
    index: Int[Array, " worlds"],
    purpose: int,
    advance: Callable[[float], None] = lambda share: None,
) -> Driven:
    """Follows `plan` (leaves with a leading worlds axis) in every world.

    purpose: of the random numbers. advance: told the share of the planned time that each block added. Raises
    InputError for a differential base: plans have ways of the base that it cannot go.
    """
    check_goes_sideways(job.robot)
    kind = type(plan)
    plan = jax.tree.map(np.asarray, plan)
    state = _START[kind](job, _window(plan, np.zeros(len(plan.rows))), worlds)
    duration = np.asarray(plan.duration)
    longest = float(np.max(duration, initial=0.0, where=np.isfinite(duration)))
    records, done = [], 0.0
    for number in range(max(1, math.ceil(_PATIENCE * longest / (_BLOCK * float(job.dt))) + 1)):
        part = _window(plan, np.asarray(state.clock))
        state, record = _BLOCKS[kind](job, part, state, index, jnp.array([purpose, number], jnp.int32))
        records.append(jax.tree.map(np.asarray, record))
        live = (np.asarray(state.clock) < duration) & (np.asarray(state.diverged_at) < 0)
        share = min(1.0, float(np.mean(np.asarray(state.clock))) / max(longest, 1e-9))
        advance(share - done)
        done = share
        if not live.any():
            break
    advance(1 - done)
    record = jax.tree.map(lambda *parts: np.concatenate(parts, axis=1), *records)
    diverged = (np.asarray(state.diverged_at) >= 0) | ~np.isfinite(duration)
    return Driven(state, record, (np.asarray(state.clock) >= duration) & ~diverged, diverged)


def _window(plan: JointPlan | BrushPlan, clock: np.ndarray) -> JointPlan | BrushPlan:
    """The plan with only those rows that the next block can need: moving all of them costs more than the
    block, and plans of all lengths have one shape.
    """
    rows, origin = _cut(np.asarray(plan.rows), np.asarray(plan.step), clock, WINDOW)
    plan = plan._replace(rows=rows, origin=origin)
    if isinstance(plan, JointPlan):
        return plan
    step = np.asarray(plan.station_step)
    ratio = float((np.asarray(plan.step) / step).max(initial=0.0))
    count = math.ceil(round(WINDOW * ratio, 3)) + 2
    stations, begin = _cut(np.asarray(plan.stations), step, clock, count)
    return plan._replace(stations=stations, station_origin=begin)


def _cut(rows: np.ndarray, step: np.ndarray, clock: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """So many rows from shortly before the clock on, and the time of the first [s]."""
    first = np.floor(np.nan_to_num(clock) / step).astype(int) - 1
    first = np.clip(first, 0, max(rows.shape[1] - 2, 0))
    index = np.minimum(first[:, None] + np.arange(count), rows.shape[1] - 1)
    return np.take_along_axis(rows, index[..., None], axis=1), (first * step).astype(step.dtype)
