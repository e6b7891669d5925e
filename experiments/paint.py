"""The main job: a picture painted on a wall in many randomised worlds."""

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from typing import Any, cast

import jax
import numpy as np
from matplotlib.colors import to_hex

from experiments.commands.paint_options import PaintOptions
from experiments.commands.paint_outcome import PaintOutcome
from experiments.dropped import dropped_words
from experiments.exports.planned import planned
from experiments.interrupts import Stop, held
from experiments.paint_job import PaintTask, paint_task
from experiments.paint_report import report_data
from experiments.recording import Recording, chosen, joined, recorded, shown
from experiments.report.stroke_preview import stroke_preview
from sims.painting.decide import Chooser
from sims.painting.lay import paint_scores
from sims.painting.mission import Mission, run_mission
from sims.painting.views_seen import share_seen
from sims.randomise import Ranges, randomised
from sims.rollout import RECORD_EVERY
from sims.scoring import WorldScore, summarise, world_scores

# Worlds that a device computes side by side: what `batched` takes at a time, and fills up to.
CHUNK = 32
# Worlds that run at once at most: what memory likes.
MOST = 256

COLUMNS = {
    "status": "status",
    "tracking_rmse": "rmse_total",
    "tracking_rmse_x": "rmse_x",
    "tracking_rmse_y": "rmse_y",
    "tracking_rmse_z": "rmse_z",
    "tracking_p95": "error_p95",
    "tracking_max": "error_max",
    "normal_error_deg": "normal_error_mean_deg",
    "normal_error_deg_p95": "normal_error_p95_deg",
    "coverage": "coverage",
    "excess": "excess",
    "stroke_error": "stroke_error_mean",
    "stroke_error_p95": "stroke_error_p95",
    "stroke_error_judged": "stroke_error_judged",
    "thickness_cv": "thickness_cv",
    "gap_length": "gap_length",
    "odometry_drift": "odometry_drift_mean",
    "odometry_drift_max": "odometry_drift_max",
    "base_travel": "base_travel",
    "halts": "halts",
    "duration": "duration",
    "chamfer_l1": "chamfer_l1_raw",
    "chamfer_l2": "chamfer_l2_raw",
}
"""Columns of runs.parquet that are scores, by the names of `sims.scoring.WorldScore`."""


def run(options: PaintOptions, progress: Callable[..., AbstractContextManager[Any]]) -> PaintOutcome:
    """Scan, map, decide, move, paint and score in all worlds. Raises InputError for bad input."""
    task = paint_task(options)
    groups = groups_of(options.worlds)
    missions, rows, kept = [], [], []
    with held() as interrupts, progress("paint", float(len(groups))) as bar:
        for index in groups:
            try:
                mission = _mission(task, options, index, interrupts.checked(bar.advance))
                rows += score(task, mission)
            except Stop:
                break
            kept += chosen(task, mission, index, options.record)
            missions.append(mission if not missions else _light(mission))
            interrupts.keep()
    summary = summarise(rows) | {
        "path": _path(task, missions),
        "viewpoints": _viewpoints(task),
        "modes": _modes(missions),
        "control_steps": int(sum(steps_of(m).sum() for m in missions)),
        "steps_per_s": float(sum(steps_of(m).sum() for m in missions) / sum(m.executed_s for m in missions)),
    }
    plan, refused = planned(task.job, missions, options.export_world) if options.export else (None, "")
    return PaintOutcome(
        summary=summary,
        worlds=_columns(rows, missions, options),
        trajectories=_trajectories(task, missions[0], rows, kept, options.record),
        report=report_data(task, missions[0], rows),
        resolved=task.resolved,
        notes=(
            *task.notes,
            *_dropped(task, missions),
            *_unrecorded(options.record, len(rows)),
            *([refused] if refused else []),
        ),
        interrupted=len(rows) < options.worlds,
        plan=plan,
        refused=refused,
        preview=stroke_preview(task.strokes, task.drawing, radius=options.brush_radius),
    )


def groups_of(worlds: int) -> list[np.ndarray]:
    """Indices of the worlds that run together; a run that is broken off keeps whole groups.

    On CPUs a group is one chunk for each device: fewer worlds would take as long, since chunks are filled up,
    and more are not done sooner. Other devices do better the more they are given.
    """
    size = min(MOST, CHUNK * jax.local_device_count()) if jax.default_backend() == "cpu" else MOST
    return np.array_split(np.arange(worlds), -(-worlds // size))


def _mission(task: PaintTask, options: PaintOptions, index: np.ndarray, advance) -> Mission:
    controller, job = cast(Chooser, options.controller), task.job
    if options.randomise:
        job = randomised(job, Ranges().scaled(options.randomise, options.friction), index)
    return run_mission(job, task.grid, index, controller=controller, advance=advance)


def score(task: PaintTask, mission: Mission) -> list[WorldScore]:
    """One row of scores a world."""
    record, laid = mission.driven.record, mission.laid
    down = np.asarray(record.live) & (np.asarray(record.pen) > 0.5)
    paint = paint_scores(task.wanted, task.grid, laid, down, film=float(task.job.brush.film))
    step = float(task.job.dt) * RECORD_EVERY
    return world_scores(mission.status, laid.tracking, paint, mission.surface, mission.surface, step=step)


def steps_of(mission: Mission) -> np.ndarray:
    """Live control steps of each world's execution."""
    return np.asarray(mission.driven.state.steps)


def _light(mission: Mission) -> Mission:
    """Without the big arrays, which only the first group's report needs; of worlds whose trajectories a user
    asked for, `kept` has them.
    """
    none = np.zeros((len(mission.status), 0, 3))
    laid = mission.laid._replace(thickness=None, uv=none[..., :2], colour=None)
    record = jax.tree.map(lambda x: np.asarray(x)[:, :0].copy(), mission.driven.record)
    driven = mission.driven._replace(record=record)
    truth = mission.truth.__class__(none, none)
    return mission._replace(clouds=(none, none), truth=truth, laid=laid, driven=driven)


def _trajectories(
    task: PaintTask, first: Mission, rows: list[WorldScore], kept: list[Recording], worlds: Sequence[int]
) -> Recording:
    """Arrays of the worlds that a user named, or else of a few of the first group, whose rows come first."""
    return joined(kept, worlds) if kept else recorded(task, first, shown(rows[: len(first.status)]))


def _unrecorded(worlds: Sequence[int], finished: int) -> list[str]:
    """Which of the worlds that a user named are not in trajectories.npz, in words."""
    lost = [str(world) for world in worlds if world >= finished]
    return [f"not recorded, as not finished: world {', '.join(lost)}"] if lost else []


def _path(task: PaintTask, missions: list[Mission]) -> dict:
    """Length and travel in the mean over worlds."""
    down = np.concatenate([np.asarray(m.painting.path.down) for m in missions])
    travel = np.concatenate([np.asarray(m.painting.path.travel) for m in missions])
    return {
        "strokes": int(task.strokes.count),
        "points": len(task.strokes.points),
        "length": float(down.mean()),
        "travel": float(travel.mean()),
        "passes": _passes(task),
    }


def _passes(task: PaintTask) -> list[dict]:
    """What is painted with each colour, in order."""
    found = []
    for number, colour in enumerate(task.drawing.colours):
        mine = [line for line, k in zip(task.strokes.lines, task.strokes.colour, strict=True) if k == number]
        length = sum(float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum()) for line in mine)
        found.append({"colour": to_hex(colour), "strokes": len(mine), "length": length})
    return found


def _viewpoints(task: PaintTask) -> dict:
    """How many views the scan takes, the fewest there could be, and the share of the area that they cover: as
    the planner's model has it, and by true rays.
    """
    views, job = task.views, task.job
    return {
        "views": len(views.camera),
        "lower_bound": int(views.lower_bound),
        "coverage": float(views.coverage),
        "coverage_seen": share_seen(job.scene, job.canvas, job.camera, views),
    }


def _modes(missions: list[Mission]) -> dict[str, float]:
    """Share of the decisions (viewpoints, strokes) for each controller."""
    chosen = np.concatenate([np.concatenate([m.modes.scan, m.modes.paint]) for m in missions])
    share = float(np.mean(chosen))
    return {"trajectory": 1 - share, "whole-body": share}


def _columns(rows: list[WorldScore], missions: list[Mission], options: PaintOptions) -> dict[str, np.ndarray]:
    """runs.parquet: one entry a world."""
    columns = {column: np.array([getattr(row, name) for row in rows]) for column, name in COLUMNS.items()}
    count = len(rows)
    steps = np.concatenate([steps_of(m) for m in missions])
    diverged = np.concatenate([np.asarray(m.driven.state.diverged_at) for m in missions])
    return {
        "world": np.arange(count),
        "seed": np.full(count, options.seed),
        **columns,
        "control_steps": steps,
        "diverged_at": diverged,
    }


def _dropped(task: PaintTask, missions: list[Mission]) -> list[str]:
    """What of the picture was left out, in words."""
    status = np.concatenate([np.asarray(m.painting.path.status) for m in missions])
    return dropped_words(np.asarray(task.strokes.stroke), status)
