"""The scores of a painting run, as a person reads them."""

import dataclasses
from collections.abc import Mapping

import numpy as np

from experiments.tables import Table


@dataclasses.dataclass(frozen=True)
class Score:
    """A column of runs.parquet: its name for a person, the unit shown and the factor to it from SI.

    spread: is it drawn, and not only listed? low_is_bad: which end of the worlds is the bad one.
    """

    column: str
    name: str
    unit: str = ""
    factor: float = 1.0
    spread: bool = False
    low_is_bad: bool = False


SCORES = (
    Score("tracking_rmse", "tracking RMSE", "mm", 1e3, spread=True),
    Score("tracking_rmse_x", "tracking RMSE, x", "mm", 1e3),
    Score("tracking_rmse_y", "tracking RMSE, y", "mm", 1e3),
    Score("tracking_rmse_z", "tracking RMSE, z", "mm", 1e3),
    Score("tracking_p95", "tracking error, 95 %", "mm", 1e3),
    Score("tracking_max", "tracking error, largest", "mm", 1e3),
    Score("normal_error_deg", "brush normal error, mean", "°", spread=True),
    Score("normal_error_deg_p95", "brush normal error, 95 %", "°"),
    Score("coverage", "coverage", "%", 100, spread=True, low_is_bad=True),
    Score("excess", "excess", "%", 100, spread=True),
    Score("stroke_error", "stroke error, mean", "mm", 1e3, spread=True),
    Score("stroke_error_p95", "stroke error, 95 %", "mm", 1e3),
    Score("thickness_cv", "thickness variation"),
    Score("gap_length", "gaps where strokes join", "m"),
    Score("odometry_drift", "odometry drift", "mm", 1e3, spread=True),
    Score("base_travel", "base travel", "m"),
    Score("halts", "base halts"),
    Score("duration", "simulated time", "s"),
)


def values_of(worlds: Mapping[str, np.ndarray], score: Score) -> np.ndarray:
    """One score of every world in the unit shown; NaN for all where the run has no such column."""
    count = len(next(iter(worlds.values()))) if worlds else 0
    column = np.asarray(worlds[score.column], float) if score.column in worlds else np.full(count, np.nan)
    return column * score.factor


def score_table(worlds: Mapping[str, np.ndarray]) -> Table:
    """Median, 5 to 95 % and the worst world of every score that the run has."""
    rows = []
    for score in SCORES:
        values = values_of(worlds, score)
        values = values[np.isfinite(values)]
        if len(values):
            low, middle, high = np.quantile(values, (0.05, 0.5, 0.95)).tolist()
            worst = float(values.min() if score.low_is_bad else values.max())
            rows.append((score.name, score.unit, middle, low, high, worst))
    return Table(("score", "unit", "median", "5 %", "95 %", "worst"), tuple(rows), title="Scores over worlds")
