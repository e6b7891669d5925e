"""What a painting run shows: the pictures of its report."""

from collections.abc import Sequence

import jax
import jax.numpy as jnp
import numpy as np

from experiments.paint_job import PaintTask
from experiments.recording import shown
from experiments.report.paint import ReportData
from experiments.report.painted_wall import PaintedWall
from experiments.report.surface_path import SurfacePath
from experiments.report.tracking_error import TrackingError
from jaxpaint.mapping.mapped import Cause
from sims.painting.mission import Mission
from sims.rollout import RECORD_EVERY
from sims.scenes.charts import AbstractChart
from sims.scoring import WorldScore
from sims.scoring.paint import PAINTED_SHARE

# Rows and columns of the drawn surface.
_SURFACE = (24, 64)


def report_data(task: PaintTask, mission: Mission, rows: Sequence[WorldScore]) -> ReportData:
    """The pictures of the first group's worlds."""
    worlds = shown(rows[: len(mission.status)])
    names = ("median world", "worst world")
    walls = tuple(
        _wall(task, mission, world, f"{name}, {world}") for name, world in zip(names, worlds, strict=False)
    )
    grid = _on_paint_grid(task)
    return ReportData(
        wanted=grid[0],
        surface=grid[1],
        walls=walls,
        path=_path(task, mission, worlds[0]),
        tracking=_tracking(task, mission),
        dropped=dropped_points([mission]),
        palette=task.drawing.colours,
    )


def dropped_points(missions: Sequence[Mission]) -> dict[str, int]:
    """Points of the picture that were not mapped, by cause, in the median world."""
    causes = np.median(np.concatenate([np.asarray(m.painting.causes) for m in missions]), axis=0)
    return {cause.name.lower(): int(causes[cause]) for cause in Cause if cause != Cause.HIT}


def _wall(task: PaintTask, mission: Mission, world: int, name: str) -> PaintedWall:
    thickness = mission.laid.films[world].copy()  # or it would hold the whole group's
    cell, origin = float(task.grid.cell), np.asarray(task.grid.origin, float)
    rows, columns = task.grid.shape
    lower = origin - cell / 2
    upper = lower + cell * np.array([columns, rows])
    painted = thickness >= PAINTED_SHARE * float(task.job.brush.film)
    return PaintedWall(thickness, painted, (lower[0], lower[1]), (upper[0], upper[1]), name)


def _on_paint_grid(task: PaintTask) -> tuple[np.ndarray, np.ndarray]:
    """The wanted picture, colour by colour, and the surface, at the middles of the paint grid's cells."""
    centres = np.asarray(task.grid.centres(), float)
    wanted = task.wanted
    index = wanted.index(centres.reshape(-1, 2)).reshape(task.grid.shape)
    masks = np.stack([layer.mask.ravel()[index] for layer in wanted.layers])
    return masks, wanted.on_surface.ravel()[index]


def _path(task: PaintTask, mission: Mission, world: int) -> SurfacePath:
    record, truth = jax.tree.map(np.asarray, mission.driven.record), mission.truth
    live = record.live[world]
    normal = -truth.axis[world][live]
    return SurfacePath(
        p_map=truth.position[world][live],
        normal=normal,
        pen=record.pen[world][live] > 0.5,
        surface=_surface(task),
        base=record.base[world][live][::5, :2],
    )


def _surface(task: PaintTask) -> np.ndarray:
    """Points of the wall about the canvas, NaN in holes."""
    centres = np.asarray(task.grid.centres())
    rows = np.linspace(0, centres.shape[0] - 1, _SURFACE[0]).astype(int)
    columns = np.linspace(0, centres.shape[1] - 1, _SURFACE[1]).astype(int)
    uv = jnp.asarray(centres[np.ix_(rows, columns)].reshape(-1, 2))
    chart: AbstractChart = task.job.scene.chart
    points = jax.jit(jax.vmap(chart.point))(uv)
    there = jax.jit(jax.vmap(chart.on_surface))(uv)
    return np.where(np.asarray(there)[:, None], np.asarray(points), np.nan).reshape(*_SURFACE, 3)


def _tracking(task: PaintTask, mission: Mission) -> TrackingError:
    """Quantiles over worlds of the distance from the plan, pen up included."""
    record = jax.tree.map(np.asarray, mission.driven.record)
    live = record.live
    longest = int(max(live.any(axis=0).sum(), 1))
    error = np.linalg.norm(mission.truth.position - record.planned, axis=-1)
    error = np.where(live, error, np.nan)[:, :longest]
    low, median, high = (
        np.nanpercentile(error, [5, 50, 95], axis=0) if live.any() else np.full((3, longest), np.nan)
    )
    alive = np.maximum(live.sum(axis=0), 1)
    return TrackingError(
        time=np.arange(longest) * float(task.job.dt) * RECORD_EVERY,
        low=low,
        median=median,
        high=high,
        pen=np.median(record.pen, axis=0)[:longest] > 0.5,
        halted=((record.halted * live).sum(axis=0) / alive)[:longest],
    )
