"""Scores over worlds, under the keys of the command line's contract; numpy only."""

import math
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from jaxpaint.clouds import Chamfer
from sims.scoring.paint import PaintScore
from sims.scoring.tracking import TrackingScore
from sims.status import Status


@dataclass(frozen=True)
class WorldScore:
    """One world's row: SI units, angles in degrees where the name says so, NaN where a figure is missing."""

    status: str
    rmse_x: float
    rmse_y: float
    rmse_z: float
    rmse_total: float
    error_p95: float
    error_max: float
    normal_error_mean_deg: float
    normal_error_p95_deg: float
    coverage: float
    excess: float
    thickness_cv: float
    gap_length: float
    stroke_error_mean: float
    stroke_error_p95: float
    stroke_error_judged: float
    chamfer_l1_raw: float
    chamfer_l2_raw: float
    chamfer_l1_refined: float
    chamfer_l2_refined: float
    odometry_drift_mean: float
    odometry_drift_max: float
    base_travel: float
    halts: int
    duration: float
    control_steps: int


def world_scores(
    status: np.ndarray,
    tracking: TrackingScore,
    paint: Sequence[PaintScore],
    raw: Chamfer | None,
    refined: Chamfer | None,
    *,
    step: float,
) -> list[WorldScore]:
    """One row a world; array leaves of the parts have a leading worlds axis. step: control period [s]."""
    return [_row(world, status, tracking, paint[world], raw, refined, step) for world in range(len(status))]


def _row(world: int, status, tracking, paint: PaintScore, raw, refined, step: float) -> WorldScore:
    def at(values) -> float:
        return float(np.asarray(values)[world])

    def surface(part: Chamfer | None, name: str) -> float:
        return math.nan if part is None else at(getattr(part, name))

    rmse = np.asarray(tracking.rmse)[world]
    return WorldScore(
        status=Status(int(np.asarray(status)[world])).label,
        rmse_x=float(rmse[0]),
        rmse_y=float(rmse[1]),
        rmse_z=float(rmse[2]),
        rmse_total=at(tracking.total),
        error_p95=at(tracking.p95),
        error_max=at(tracking.largest),
        normal_error_mean_deg=math.degrees(at(tracking.normal_mean)),
        normal_error_p95_deg=math.degrees(at(tracking.normal_p95)),
        coverage=paint.coverage,
        excess=paint.excess,
        thickness_cv=paint.thickness_cv,
        gap_length=paint.gap_length,
        stroke_error_mean=paint.stroke_error_mean,
        stroke_error_p95=paint.stroke_error_p95,
        stroke_error_judged=paint.stroke_error_judged,
        chamfer_l1_raw=surface(raw, "l1"),
        chamfer_l2_raw=surface(raw, "l2"),
        chamfer_l1_refined=surface(refined, "l1"),
        chamfer_l2_refined=surface(refined, "l2"),
        odometry_drift_mean=at(tracking.drift_mean),
        odometry_drift_max=at(tracking.drift_largest),
        base_travel=at(tracking.travel),
        halts=int(at(tracking.halts)),
        duration=at(tracking.steps) * step,
        control_steps=int(at(tracking.steps)),
    )


def summarise(scores: Sequence[WorldScore]) -> dict[str, Any]:
    """All figures over worlds, as in summary.json; null where a figure does not exist.

    Medians over worlds, in which a failed world's errors (tracking, brush normal, stroke) are infinite: where
    half of the worlds or more failed, the median is null and `status` says why. Other figures are what was
    reached, with a failed world's coverage 0 and its other missing figures infinite. halts and duration are
    means, control_steps is the sum over worlds.
    """
    errors, reached = _reader(scores, _error), _reader(scores, _measured)
    return {
        "worlds": len(scores),
        "status": dict(sorted(Counter(s.status for s in scores).items())),
        "tracking_rmse": {
            **{axis: errors(f"rmse_{axis}") for axis in ("x", "y", "z", "total")},
            "p95": errors("error_p95"),
            "max": errors("error_max"),
        },
        "normal_error_deg": {kind: errors(f"normal_error_{kind}_deg") for kind in ("mean", "p95")},
        "paint": {
            "coverage": _reader(scores, _coverage)("coverage"),
            **{name: reached(name) for name in ("excess", "thickness_cv", "gap_length")},
            "stroke_error": {
                **{kind: errors(f"stroke_error_{kind}") for kind in ("mean", "p95")},
                "judged": reached("stroke_error_judged"),
            },
        },
        "surface": {
            name: reached(name)
            for name in ("chamfer_l1_raw", "chamfer_l1_refined", "chamfer_l2_raw", "chamfer_l2_refined")
        },
        "odometry_drift": {kind: reached(f"odometry_drift_{kind}") for kind in ("mean", "max")},
        "base_travel": reached("base_travel"),
        "halts_per_run": _finite(np.mean([s.halts for s in scores])),
        "duration": _finite(np.mean([s.duration for s in scores])),
        "control_steps": sum(s.control_steps for s in scores),
    }


def _reader(scores: Sequence[WorldScore], value: Callable[[WorldScore, str], float]) -> Callable[[str], Any]:
    return lambda name: _finite(np.median([value(score, name) for score in scores]))


def _error(score: WorldScore, name: str) -> float:
    figure = getattr(score, name)
    return figure if score.status == Status.OK.label and math.isfinite(figure) else math.inf


def _measured(score: WorldScore, name: str) -> float:
    figure = getattr(score, name)
    return figure if math.isfinite(figure) else math.inf


def _coverage(score: WorldScore, name: str) -> float:
    """What a diverged world painted before is no achievement; other failures keep what they reached."""
    figure = getattr(score, name)
    whole = score.status != Status.DIVERGED.label and math.isfinite(figure)
    return figure if whole else 0.0


def _finite(figure: np.floating | float) -> float | None:
    return float(figure) if math.isfinite(figure) else None
