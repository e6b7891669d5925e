"""Many worlds follow a study's curve, and are scored."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from experiments.tracking.study import Study
from jaxpaint.compiling import batched, one_by_one
from sims.odometry import draw_slip
from sims.painting.approach import first_posture
from sims.painting.drive import BrushPlan, Driven, drive
from sims.painting.job import PAINT, SLIP, Job
from sims.painting.lay import log_of, true_brush
from sims.rollout import RECORD_EVERY, Record
from sims.scoring import Log, Tally, TrackingScore, accumulate, tracking_score
from sims.worlds import World, standing


@dataclasses.dataclass(frozen=True)
class Followed:
    """score: of each world. completed: whether it came to the curve's end. time: simulated [s]. starts: how
    often the base set off. planned, brush: of each world at the records [m]. live: which records count.
    """

    score: TrackingScore
    completed: np.ndarray
    time: np.ndarray
    starts: np.ndarray
    planned: Float[np.ndarray, "worlds time 3"]
    brush: Float[np.ndarray, "worlds time 3"]
    live: np.ndarray


def _at_the_start(job: Job, row: Float[Array, "19"], station: Float[Array, "3"], index: Int[Array, ""]):
    slip = draw_slip(job.noise.odometry, job.limits.drive.size, key=job.key(index, SLIP))
    size = job.limits.drive.size
    there = standing(station, job.robot.home, slip, size)
    way, _ = first_posture(job, there, row, station)
    return standing(way[1, :3], way[1, 3:], slip, size)


# Speed of a base that moves [m/s], and how long one stands still that rests [s].
_SETS_OFF, _REST = 0.005, 0.5
_START = batched(_at_the_start, in_axes=(None, None, None, 0))
_SCORE = one_by_one(
    lambda log, chart: tracking_score(accumulate(Tally.zero(log.brush.dtype), log, chart)), in_axes=(0, None)
)


def start_worlds(study: Study, index: Int[Array, " worlds"]) -> World:
    """Robots at rest with the brush where the curve begins, who know where they are."""
    rows, places = jnp.asarray(study.plan.rows[0]), jnp.asarray(study.plan.stations[0])
    return _START(study.job, rows, places, index)


def follow(study: Study, worlds: int, first: int = 0) -> Followed:
    """Follows the curve in the worlds of indices first, first + 1, ..."""
    driven = drive_study(study, worlds, first)
    truth = true_brush(study.job, driven)
    log: Log = log_of(driven, truth)
    score = jax.tree.map(np.asarray, _SCORE(log, study.job.scene.chart))
    time = np.asarray(driven.state.steps) * float(study.job.dt)
    return Followed(
        score,
        driven.completed,
        time,
        base_starts(driven.record, float(study.job.dt)),
        np.asarray(log.planned),
        truth.position,
        np.asarray(log.live),
    )


def drive_study(study: Study, worlds: int, first: int = 0) -> Driven:
    """The same, not scored."""
    index = jnp.arange(first, first + worlds, dtype=jnp.int32)
    plan = BrushPlan(*(np.repeat(np.asarray(x)[None], worlds, axis=0) for x in study.plan))
    return drive(study.job, plan, start_worlds(study, index), index, PAINT)


def base_starts(record: Record, dt: float) -> np.ndarray:
    """How often the true base of each world sets off, faster than odometry's dead band, after a rest of half
    a second or more.
    """
    step = RECORD_EVERY * dt
    way = np.linalg.norm(np.diff(record.base[..., :2], axis=1), axis=-1)
    moving = (way > _SETS_OFF * step) & record.live[:, 1:]
    rest = max(1, round(_REST / step))
    before = np.concatenate([np.zeros_like(moving[:, :rest]), moving], axis=1)
    rested = ~np.stack([before[:, k : k + moving.shape[1]] for k in range(rest)]).any(0)
    return (moving & rested).sum(1)


def median_interval(values: Float[np.ndarray, " worlds"]) -> tuple[float, float, float]:
    """The median and its 95 % interval by order statistics, which asks for no distribution."""
    ordered = np.sort(values)
    half = 0.98 * np.sqrt(len(values))
    low = max(0, int(np.floor(len(values) / 2 - half)))
    high = min(len(values) - 1, int(np.ceil(len(values) / 2 + half)))
    return float(np.median(values)), float(ordered[low]), float(ordered[high])
