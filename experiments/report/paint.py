"""The report of a painting run."""

import dataclasses
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Bool

from experiments.report.colours import Palette
from experiments.report.page import Page, Section, Tile
from experiments.report.painted_wall import PaintedWall, painted_wall
from experiments.report.scores import SCORES, score_table, values_of
from experiments.report.settings import settings
from experiments.report.spread import Spread, spread
from experiments.report.surface_path import SurfacePath, surface_path
from experiments.report.tracking_error import TrackingError, tracking_error
from experiments.tables import Table, in_words, quantity


@dataclasses.dataclass(frozen=True)
class ReportData:
    """What a painting run gives its report besides summary and worlds.

    wanted: cells of the surface's grid that the picture inks, row 0 lowest.
    surface: cells on the wall, None for all.
    walls: the median world, then the worst, on the same grid.
    dropped: points that were not mapped, by cause.
    palette: sRGB of the picture's colours [0..1]; of several, wanted and walls have them as leading axis.
    more: sections of the caller's own, such as the scan.
    """

    wanted: Bool[np.ndarray, "*colours rows columns"]
    walls: tuple[PaintedWall, ...]
    path: SurfacePath
    tracking: TrackingError
    surface: Bool[np.ndarray, "rows columns"] | None = None
    dropped: Mapping[str, int] = dataclasses.field(default_factory=dict)
    more: tuple[Section, ...] = ()
    palette: Palette = ()


def build_page(
    data: ReportData,
    summary: Mapping[str, Any],
    worlds: Mapping[str, np.ndarray],
    notes: tuple[str, ...] = (),
) -> Page:
    """The page from the run's summary (all keys), its worlds (columns of runs.parquet) and its pictures."""
    good = int(summary["status"].get("ok", 0))
    return Page(
        title=_title(summary["config"]),
        verdict=_verdict(good, summary),
        mood="good" if good == summary["worlds"] else "mixed" if good else "bad",
        tiles=_tiles(summary),
        sections=(
            Section(
                "Painted wall",
                " ".join(notes),
                (painted_wall(data.wanted, data.walls, data.surface, data.palette),),
            ),
            _path_section(data, summary["path"]),
            Section("Tracking", _tracking_text(summary), (tracking_error(data.tracking),)),
            _worlds_section(summary, worlds),
            *data.more,
            settings(summary),
        ),
        footer="runs.parquet beside this page has every world, trajectories.npz a few in full.",
    )


def _title(config: Mapping[str, Any]) -> str:
    picture = Path(config["image"]).name if config.get("image") else "built-in drawing"
    parts = (f"{picture} on {Path(config['wall']).name}", config["fidelity"], config["controller"])
    return f"jaxpaint paint: {', '.join(parts)}, seed {config['seed']}"


def _verdict(good: int, summary: Mapping[str, Any]) -> str:
    error = summary["tracking_rmse"]["total"]
    words = f"{good} of {summary['worlds']} worlds painted"
    return words if error is None else f"{words}, median tracking error {in_words(error * 1e3)} mm RMSE"


def _tiles(summary: Mapping[str, Any]) -> tuple[Tile, ...]:
    rmse, paint, normal = summary["tracking_rmse"], summary["paint"], summary["normal_error_deg"]
    stroke = paint["stroke_error"] or {}
    return (
        Tile("Coverage", quantity(paint["coverage"], 100, "%"), "of the wanted area"),
        Tile("Excess", quantity(paint["excess"], 100, "%"), "over 5 mm outside of it"),
        Tile(
            "Stroke error",
            quantity(stroke.get("mean"), 1e3, "mm"),
            f"95 %: {quantity(stroke.get('p95'), 1e3, 'mm')}",
        ),
        Tile(
            "Tracking RMSE", quantity(rmse["total"], 1e3, "mm"), f"largest {quantity(rmse['max'], 1e3, 'mm')}"
        ),
        Tile("Brush normal", quantity(normal["mean"], 1, "°"), f"95 %: {quantity(normal['p95'], 1, '°')}"),
        Tile(
            "Simulated time",
            quantity(summary["duration"], 1, "s"),
            f"{quantity(summary['steps_per_s'], 1, 'steps/s')}",
        ),
    )


def _path_section(data: ReportData, path: Mapping[str, Any]) -> Section:
    length, travel = quantity(path["length"], 1, "m"), quantity(path["travel"], 1, "m")
    text = f"{path['strokes']} strokes, {length} in all, {path['points']} points; {travel} between strokes."
    dropped = {cause: count for cause, count in data.dropped.items() if count}
    tables = (_counts("Points not mapped, by cause", dropped),) if dropped else ()
    return Section("Path on the surface", text, (surface_path(data.path),), tables)


def _tracking_text(summary: Mapping[str, Any]) -> str:
    drift = summary["odometry_drift"]
    modes = ", ".join(f"{name} {quantity(share, 100, '%')}" for name, share in summary["modes"].items())
    travel, halts = quantity(summary["base_travel"], 1, "m"), quantity(summary["halts_per_run"], 1, "halts")
    mean, most = quantity(drift["mean"], 1e3, "mm"), quantity(drift["max"], 1e3, "mm")
    return (
        f"The base travels {travel} with {halts} a run; odometry errs by {mean} in the mean, {most} at most. "
        f"Decisions by controller: {modes or 'none'}."
    )


def _worlds_section(summary: Mapping[str, Any], worlds: Mapping[str, np.ndarray]) -> Section:
    drawn = [Spread(score.name, score.unit, values_of(worlds, score)) for score in SCORES if score.spread]
    tables = (score_table(worlds), _counts("Worlds by status", summary["status"]))
    return Section("All worlds", "", (spread(tuple(drawn)),), tables)


def _counts(title: str, counts: Mapping[str, int]) -> Table:
    return Table(("", "count"), tuple((name, int(count)) for name, count in counts.items()), title)
