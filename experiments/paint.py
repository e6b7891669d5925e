"""The main job: a picture painted on a wall in many randomised worlds."""

import dataclasses
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from typing import Any, cast

import numpy as np
from matplotlib.colors import to_hex

from experiments.commands.paint_options import PaintOptions
from experiments.commands.paint_outcome import PaintOutcome
from experiments.dropped import dropped_words
from experiments.exports.planned import not_finished, planned
from experiments.finished import Finished, together
from experiments.interrupts import Interrupts, Stop, held
from experiments.memory_plan import memory_plan
from experiments.paint_job import PaintTask, paint_task
from experiments.paint_report import report_data
from experiments.processes import peers
from experiments.progress import silent
from experiments.recording import Recording, chosen, joined, recorded, shown
from experiments.report.paint import ReportData
from experiments.report.stroke_preview import stroke_preview
from sims.painting.decide import Chooser
from sims.painting.joint_plan import JointTrajectory
from sims.painting.lay import paint_scores
from sims.painting.mission import Mission, run_mission
from sims.painting.views_seen import share_seen
from sims.randomise import Ranges, randomised
from sims.rollout import RECORD_EVERY
from sims.scoring import WorldScore, summarise, world_scores

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
    task, others = paint_task(options), peers()
    memory = memory_plan(task, options)
    with held() as interrupts:
        share = _share(task, options, memory.group, progress, interrupts)
        parts = others.gather(_handed_in(share), interrupts)
    found = [Finished.from_bytes(part) for part in parts if part]
    done, executed = together(found), max(part.executed_s for part in found)
    rows, steps = done.rows, int(done.steps.sum())
    refused = _refused(options, share)
    summary = summarise(rows) | {
        "path": _path(task, done),
        "viewpoints": _viewpoints(task),
        "modes": _modes(done),
        "control_steps": steps,
        "steps_per_s": steps / executed,
        "memory": memory.summary(),
        "processes": others.count,
    }
    return PaintOutcome(
        summary=summary,
        worlds=_columns(rows, done, options),
        trajectories=joined(share.kept, options.record) if share.kept else share.trajectories,
        report=cast(ReportData, share.report),
        resolved=task.resolved,
        notes=(
            *task.notes,
            *_dropped(task, done),
            *_unrecorded(options.record, share.kept),
            *([refused] if refused else []),
        ),
        interrupted=len(rows) < options.worlds,
        plan=share.plan,
        refused=refused,
        preview=stroke_preview(task.strokes, task.drawing, radius=options.brush_radius),
    )


def run_share(options: PaintOptions) -> None:
    """The worlds of a further process: the first one is handed their figures."""
    task = paint_task(options)
    with held() as interrupts:
        share = _share(task, options, memory_plan(task, options).group, silent, interrupts)
        peers().gather(_handed_in(share), interrupts)


@dataclasses.dataclass(frozen=True)
class _Share:
    """What one process's worlds came to: of all of them a few figures, of the first group the pictures and
    trajectories. kept: trajectories of worlds that a user named.
    """

    done: Finished | None = None
    trajectories: Recording = dataclasses.field(default_factory=dict)
    kept: tuple[Recording, ...] = ()
    report: ReportData | None = None
    plan: JointTrajectory | None = None
    refused: str = ""


def _share(task: PaintTask, options: PaintOptions, size: int, progress, interrupts: Interrupts) -> _Share:
    """Runs this process's worlds, group by group; nothing of a group but its `Finished` outlives it."""
    groups = groups_of(peers().share(options.worlds), size)
    share = _Share()
    with progress("paint", float(len(groups))) as bar:
        advance = interrupts.checked(peers().checked(bar.advance))
        for index in groups:
            try:
                mission = _mission(task, options, index, advance)
                rows = score(task, mission)
            except Stop:
                break
            share = _with_group(share, task, options, index, mission, rows)
            interrupts.keep()
            del mission  # or it would lie in memory until the next one is done
    return share


def _with_group(
    share: _Share, task: PaintTask, options: PaintOptions, index, mission: Mission, rows
) -> _Share:
    """One more group; the first one is shown, and only by the first process."""
    new = Finished.of(index, mission, rows)
    if share.done is not None:
        share = dataclasses.replace(share, done=together([share.done, new]))
    else:
        first = {} if peers().number else _shown(task, mission, rows)
        share = _Share(new, **first)
    kept = chosen(task, mission, index, options.record)
    share = dataclasses.replace(share, kept=(*share.kept, *kept))
    if options.export and options.export_world in index:
        plan, refused = planned(task.job, index, mission, options.export_world)
        share = dataclasses.replace(share, plan=plan, refused=refused)
    return share


def _shown(task: PaintTask, mission: Mission, rows: list[WorldScore]) -> dict:
    return {
        "trajectories": recorded(task, mission, shown(rows)),
        "report": report_data(task, mission, rows),
    }


def _unrecorded(worlds: Sequence[int], kept: Sequence[Recording]) -> list[str]:
    """Which of the worlds that a user named are not in trajectories.npz, in words."""
    found = {world for part in kept for world in part["world"].tolist()}
    lost = [str(world) for world in worlds if world not in found]
    return [f"not recorded, as not finished: world {', '.join(lost)}"] if lost else []


def _handed_in(share: _Share) -> bytes:
    """Nothing where no group was finished."""
    return b"" if share.done is None else share.done.to_bytes()


def _refused(options: PaintOptions, share: _Share) -> str:
    """Why nothing is exported though it was asked for."""
    if not options.export or share.plan is not None:
        return ""
    return share.refused or not_finished(options.export_world)


def groups_of(index: np.ndarray, size: int) -> list[np.ndarray]:
    """Worlds that run together, at most `size`; a run that is broken off keeps whole groups."""
    return np.array_split(index, -(-len(index) // size))


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


def _path(task: PaintTask, done: Finished) -> dict:
    """Length and travel in the mean over worlds."""
    return {
        "strokes": int(task.strokes.count),
        "points": len(task.strokes.points),
        "length": float(done.down.mean()),
        "travel": float(done.travel.mean()),
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


def _modes(done: Finished) -> dict[str, float]:
    """Share of the decisions (viewpoints, strokes) for each controller."""
    share = float(np.mean(done.whole_body))
    return {"trajectory": 1 - share, "whole-body": share}


def _columns(rows: list[WorldScore], done: Finished, options: PaintOptions) -> dict[str, np.ndarray]:
    """runs.parquet: one entry a world."""
    columns = {column: np.array([getattr(row, name) for row in rows]) for column, name in COLUMNS.items()}
    return {
        "world": done.world,
        "seed": np.full(len(rows), options.seed),
        **columns,
        "control_steps": done.steps,
        "diverged_at": done.diverged_at,
    }


def _dropped(task: PaintTask, done: Finished) -> list[str]:
    """What of the picture was left out, in words."""
    return dropped_words(np.asarray(task.strokes.stroke), done.met)
