"""S1 tables I and III: how well a curve is followed, by the paper's controller as printed and by ours."""

import dataclasses
from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure

from experiments.report.style import EXCESS, PAINT, SOFT, look, new_figure
from experiments.reproduce.result import ReproduceResult, Row
from experiments.tracking import (
    Followed,
    Variant,
    follow,
    literal,
    median_interval,
    study_of,
    variants,
    varied,
)
from experiments.tracking.curves import lemniscate

WORLDS = 256
HELD_OUT = 1_000_000
"""Index of the first world, and seed of the survey: nothing was tuned on these."""
_DYNAMIC = ("ours", "literal")


@dataclasses.dataclass(frozen=True)
class TrackingTable:
    """One of the two. published: total RMSE [m]. theta: the best one for the printed controller [m]."""

    preset: str
    published: float
    theta: float


def run_table(table: TrackingTable, seed: int, worlds: int = WORLDS, dynamic: bool = True) -> ReproduceResult:
    """Rows of every variant; of the dynamic fidelity, ours and the printed controller's."""
    tried = {"literal": literal(table.theta), **variants()}
    kinematic = _followed(table, "kinematic", tried, seed, worlds)
    rows = [row for name, run in kinematic.items() for row in _rows(table, name, run)]
    if dynamic:
        chosen = {name: tried[name] for name in _DYNAMIC}
        for name, run in _followed(table, "dynamic", chosen, seed, worlds).items():
            rows.append(_row("total_dynamic", name, table.published, _total(run)))
            rows += _beside(name, run, "_dynamic")
    return ReproduceResult.of(rows, {"path": path_figure(kinematic)})


def _followed(
    table: TrackingTable, fidelity: str, tried: Mapping[str, Variant], seed: int, worlds: int
) -> dict[str, Followed]:
    """The runs of each variant."""
    first = HELD_OUT + seed * worlds
    study = study_of(lemniscate(), noise=table.preset, fidelity=fidelity, seed=first)
    return {name: follow(varied(study, variant), worlds, first) for name, variant in tried.items()}


def _total(run: Followed) -> np.ndarray:
    """RMSE of each world [m]; one that did not come to its end counts as infinitely far off."""
    return np.where(run.completed, run.score.total, np.inf)


def _rows(table: TrackingTable, name: str, run: Followed) -> list[Row]:
    axes = np.where(run.completed[:, None], run.score.rmse, np.inf)
    rows = [_row(axis, name, None, axes[:, k]) for k, axis in enumerate("xyz")]
    rows.append(_row("total", name, table.published, _total(run)))
    return rows + _beside(name, run)


def _beside(name: str, run: Followed, suffix: str = "") -> list[Row]:
    """What stands beside every RMSE: drift of odometry, base travel, halts, time, and worlds at their end."""
    figures = {
        "odometry drift, largest [m]": run.score.drift_largest,
        "base travel [m]": run.score.travel,
        "halts": run.score.halts,
        "time [s]": run.time,
    }
    rows = [_row(what + suffix, name, None, values) for what, values in figures.items()]
    return [*rows, Row("worlds at the end [1]" + suffix, name, None, float(np.mean(run.completed)))]


def _row(what: str, variant: str, published: float | None, values: np.ndarray) -> Row:
    middle, low, high = median_interval(np.asarray(values, float))
    finite = [x if np.isfinite(x) else None for x in (middle, low, high)]
    return Row(what, variant, published, *finite)


def path_figure(followed: Mapping[str, Followed]) -> Figure:
    """S1's figures 9 and 12: the curve and the way of the brush, in the wall and off it, first world."""
    shown = [name for name in ("literal", "ours") if name in followed]
    with look():
        figure = new_figure(5.5)
        axes = figure.subplots(2, len(shown), squeeze=False, height_ratios=[2, 1], sharex="col")
        for column, name in enumerate(shown):
            _draw(axes[0, column], axes[1, column], followed[name])
            axes[0, column].set_title(name)
        axes[0, 0].set_ylabel("up [m]")
        axes[1, 0].set_ylabel("off the wall [mm]")
        axes[0, -1].legend(loc="upper right")
    return figure


def _draw(front, top, run: Followed) -> None:
    live = run.live[0]
    planned, brush = run.planned[0][live], run.brush[0][live]
    front.plot(-planned[:, 1], planned[:, 2], color=EXCESS, label="planned")
    front.plot(-brush[:, 1], brush[:, 2], color=PAINT, linewidth=1, label="brush")
    front.set_aspect("equal", adjustable="datalim")
    top.axhline(0, color=SOFT, linewidth=0.8)
    top.plot(-brush[:, 1], 1e3 * (brush - planned)[:, 0], color=PAINT, linewidth=1)
    top.set_xlabel("along the wall [m]")
