"""How well one world followed its plan, and how it ended."""

from typing import Any, Self

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from sims.scenes.charts import AbstractChart
from sims.scoring.histogram import Histogram
from sims.scoring.log import Log
from sims.status import Status

WITHIN = 0.030  # of the plan, for 95 % of the pen-down time: the contract's `ok` [m]
WITHIN_SHARE = 0.95
_ERROR_BIN, _ERROR_BINS = 1e-4, 5000  # 0.1 mm up to 0.5 m
_ANGLE_BIN, _ANGLE_BINS = 0.02 * jnp.pi / 180, 9000  # 0.02 degrees up to 180


class Tally(eqx.Module):
    """Sums over the steps seen so far; steps that are not live change nothing.

    Start with `Tally.zero`, add stretches of the run in order with `accumulate`, read with `tracking_score`.
    """

    down: Int[Array, ""]
    squares: Float[Array, "3"]
    largest: Float[Array, ""]
    within: Int[Array, ""]
    errors: Histogram
    angle_sum: Float[Array, ""]
    angles: Histogram
    live: Int[Array, ""]
    drift_sum: Float[Array, ""]
    drift_largest: Float[Array, ""]
    travel: Float[Array, ""]
    halts: Int[Array, ""]
    last_base: Float[Array, "2"]
    last_halted: Bool[Array, ""]
    finite: Bool[Array, ""]

    @classmethod
    def zero(cls, dtype: Any = float) -> Self:
        """Nothing seen yet."""
        none, count = jnp.zeros((), dtype), jnp.zeros((), jnp.int32)
        return cls(
            down=count,
            squares=jnp.zeros(3, dtype),
            largest=none,
            within=count,
            errors=Histogram.empty(_ERROR_BINS, _ERROR_BIN, dtype),
            angle_sum=none,
            angles=Histogram.empty(_ANGLE_BINS, _ANGLE_BIN, dtype),
            live=count,
            drift_sum=none,
            drift_largest=none,
            travel=none,
            halts=count,
            last_base=jnp.zeros(2, dtype),
            last_halted=jnp.zeros((), bool),
            finite=jnp.ones((), bool),
        )


class TrackingScore(eqx.Module):
    """Scores of one world against the truth.

    rmse: along x, y, z of the map frame, time-matched, pen down [m]. total, p95, largest: of the distance
    [m]. normal_mean, normal_p95: angle between brush axis and true inward normal, pen down [rad]. drift_mean,
    drift_largest: of odometry, live [m]. travel: true, of the base [m]. halts: how often it was halted.
    within: share of the pen-down time within 30 mm of the plan. steps, down: live and pen-down control steps.
    finite: whether everything recorded was. All are finite; without pen-down steps they are 0.
    """

    rmse: Float[Array, "3"]
    total: Float[Array, ""]
    p95: Float[Array, ""]
    largest: Float[Array, ""]
    normal_mean: Float[Array, ""]
    normal_p95: Float[Array, ""]
    drift_mean: Float[Array, ""]
    drift_largest: Float[Array, ""]
    travel: Float[Array, ""]
    halts: Int[Array, ""]
    within: Float[Array, ""]
    steps: Int[Array, ""]
    down: Int[Array, ""]
    finite: Bool[Array, ""]


def accumulate(tally: Tally, log: Log, chart: AbstractChart) -> Tally:
    """Adds a stretch of a run; `chart` is the true wall's. Non-finite steps are noted and left out."""
    finite = _finite_steps(log)
    live = log.live & finite
    down = live & (log.pen > 0.5)
    error = jnp.where(down[:, None], log.brush - log.planned, 0)
    distance = _norm(error)
    angle = jnp.where(down, jax.vmap(lambda p, a: _normal_error(chart, p, a))(log.brush, log.axis), 0)
    drift = jnp.where(live, _norm((log.odometry - log.base)[:, :2]), 0)
    travel, halts, last_base, last_halted = _base_motion(tally, log, live)
    return Tally(
        down=tally.down + down.sum(dtype=jnp.int32),
        squares=tally.squares + (error * error).sum(0),
        largest=jnp.maximum(tally.largest, distance.max()),
        within=tally.within + (down & (distance <= WITHIN)).sum(dtype=jnp.int32),
        errors=tally.errors.add(distance, down),
        angle_sum=tally.angle_sum + angle.sum(),
        angles=tally.angles.add(angle, down),
        live=tally.live + live.sum(dtype=jnp.int32),
        drift_sum=tally.drift_sum + drift.sum(),
        drift_largest=jnp.maximum(tally.drift_largest, drift.max()),
        travel=tally.travel + travel,
        halts=tally.halts + halts,
        last_base=last_base,
        last_halted=last_halted,
        finite=tally.finite & (finite | ~log.live).all(),
    )


def tracking_score(tally: Tally) -> TrackingScore:
    """The figures of a finished run."""
    down, live = jnp.maximum(tally.down, 1), jnp.maximum(tally.live, 1)
    return TrackingScore(
        rmse=jnp.sqrt(tally.squares / down),
        total=jnp.sqrt(tally.squares.sum() / down),
        p95=jnp.minimum(tally.errors.quantile(0.95), tally.largest),
        largest=tally.largest,
        normal_mean=tally.angle_sum / down,
        normal_p95=tally.angles.quantile(0.95),
        drift_mean=tally.drift_sum / live,
        drift_largest=tally.drift_largest,
        travel=tally.travel,
        halts=tally.halts,
        within=tally.within / down,
        steps=tally.live,
        down=tally.down,
        finite=tally.finite,
    )


def judge(
    score: TrackingScore,
    *,
    completed: Bool[Array, ""],
    unreachable: Bool[Array, ""],
    infeasible: Bool[Array, ""],
    limit: Float[Array, ""] | float = 1.0,
) -> Int[Array, ""]:
    """The world's `Status` as an integer; what comes first explains what comes after.

    completed: every mapped pen-down point was executed. unreachable, infeasible: as the planner and the
    controller report. limit: a brush further than this from its plan has diverged [m].
    """
    kept = (score.within >= WITHIN_SHARE) & (score.down > 0)
    status = jnp.where(completed & kept, Status.OK.value, Status.NOT_CONVERGED.value)
    status = jnp.where(infeasible, Status.INFEASIBLE.value, status)
    status = jnp.where(unreachable, Status.UNREACHABLE.value, status)
    status = jnp.where(~score.finite | (score.largest > limit), Status.DIVERGED.value, status)
    return status.astype(jnp.int32)


def _finite_steps(log: Log) -> Bool[Array, "time"]:
    parts = [log.planned, log.brush, log.axis, log.odometry, log.base, log.pen[:, None]]
    return jnp.isfinite(jnp.concatenate(parts, axis=1)).all(1)


def _normal_error(
    chart: AbstractChart, p_map_brush: Float[Array, "3"], axis: Float[Array, "3"]
) -> Float[Array, ""]:
    """Angle [rad] between a brush axis and the inward normal of the wall at the brush's foot."""
    uv, _ = chart.to_uv(p_map_brush)
    inward = -chart.normal(uv)
    crossed = jnp.stack(
        [
            axis[1] * inward[2] - axis[2] * inward[1],
            axis[2] * inward[0] - axis[0] * inward[2],
            axis[0] * inward[1] - axis[1] * inward[0],
        ]
    )
    # The arc cosine is blunt near zero, where the scores are: 0.02 degrees in float32.
    return jnp.arctan2(_norm(crossed), (axis * inward).sum())


def _base_motion(tally: Tally, log: Log, live: Bool[Array, "time"]):
    """True travel [m] and starts of halts over live steps, with what the next stretch must know."""
    # Row 0 is what the stretch before left behind; each live step looks back to the live step before it.
    base = jnp.concatenate([tally.last_base[None], jnp.where(live[:, None], log.base[:, :2], 0)])
    halted = jnp.concatenate([tally.last_halted[None], log.halted & live])
    marks = jnp.where(live, jnp.arange(1, len(live) + 1), 0)
    latest = jnp.concatenate([jnp.zeros_like(marks[:1]), jax.lax.cummax(marks)])
    before, last = latest[:-1], latest[-1]
    known = live & ((before > 0) | (tally.live > 0))
    travel = jnp.where(known, _norm(base[1:] - base[before]), 0).sum()
    halts = (live & halted[1:] & ~halted[before]).sum(dtype=jnp.int32)
    return travel, halts, base[last], halted[last]


def _norm(vectors: Float[Array, "*batch n"]) -> Float[Array, "*batch"]:
    return jnp.sqrt((vectors * vectors).sum(-1))
