"""Two runs of one command set side by side: what differs in options, and by how much in figures."""

import dataclasses
import json
import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from experiments.output.summary import LARGEST_SUMMARY
from jaxpaint.errors import InputError

SUMMARY, WORLDS = "summary.json", "runs.parquet"
RESAMPLES = 2000
"""Resamples of the worlds behind an interval of 95 %."""


@dataclasses.dataclass(frozen=True)
class Run:
    """An earlier run: its folder, its whole summary, and the columns of runs.parquet where there are some."""

    folder: Path
    summary: Mapping[str, Any]
    worlds: Mapping[str, np.ndarray] | None


@dataclasses.dataclass(frozen=True)
class Row:
    """One figure of both runs by its key in summary.json, b - a, and the 95 % interval of that (SI)."""

    name: str
    a: float | None
    b: float | None
    difference: float | None
    low: float | None = None
    high: float | None = None


@dataclasses.dataclass(frozen=True)
class _Statistic:
    """How a figure of the summary comes from a column: the middle (median or mean) over worlds.

    A world without a figure counts as `missing`; so do, for errors, all worlds that are not ok.
    """

    column: str
    mean: bool = False
    missing: float = math.inf
    error: bool = False


_ERRORS = {
    **{f"tracking_rmse.{axis}": f"tracking_rmse_{axis}" for axis in ("x", "y", "z")},
    "tracking_rmse.total": "tracking_rmse",
    "tracking_rmse.p95": "tracking_p95",
    "tracking_rmse.max": "tracking_max",
    "normal_error_deg.mean": "normal_error_deg",
    "normal_error_deg.p95": "normal_error_deg_p95",
    "paint.stroke_error.mean": "stroke_error",
    "paint.stroke_error.p95": "stroke_error_p95",
}
_REACHED = {
    **{f"paint.{name}": name for name in ("excess", "thickness_cv", "gap_length")},
    "odometry_drift.mean": "odometry_drift",
    "odometry_drift.max": "odometry_drift_max",
    "base_travel": "base_travel",
}
STATISTICS: dict[str, _Statistic] = {
    **{name: _Statistic(column, error=True) for name, column in _ERRORS.items()},
    **{name: _Statistic(column) for name, column in _REACHED.items()},
    "paint.coverage": _Statistic("coverage", missing=0.0),
    "halts_per_run": _Statistic("halts", mean=True),
    "duration": _Statistic("duration", mean=True),
}
"""Figures of a painting run whose interval comes from its worlds."""

_NO_FIGURES = ("config", "versions", "seed", "files", "interrupted", "history", "memory", "processes")
_COUNTS = ("status.", "modes.")


def read_run(path: Path, option: str) -> Run:
    """The run in a folder, or of a summary.json; InputError, which names `option`, where there is none."""
    file = path / SUMMARY if path.is_dir() else path
    allowed = "the folder of an earlier run, or its summary.json"

    def refuse(cause: str):
        return InputError(f"{option}: found {file} ({cause}), allowed: {allowed}")

    try:
        if file.stat().st_size > LARGEST_SUMMARY:
            raise refuse("too large")
        summary = json.loads(
            file.read_text(encoding="utf-8"), parse_float=_finite, parse_int=_whole, parse_constant=_finite
        )
    except _NoNumber as error:
        raise refuse(str(error)) from error
    except (OSError, ValueError, RecursionError) as error:
        cause = (isinstance(error, OSError) and error.strerror) or "not JSON"
        raise refuse(cause) from error
    known = isinstance(summary, dict) and isinstance(summary.get("config"), dict)
    if not known or not isinstance(summary.get("command"), str):
        raise refuse("not the summary of a run")
    worlds = _read_worlds(file.parent / WORLDS, option)
    rows, count = len(next(iter(worlds.values()))) if worlds else None, summary.get("worlds")
    if rows is not None and isinstance(count, int) and rows != count:
        raise InputError(
            f"{option}: found {rows} rows in {file.parent / WORLDS}, allowed: {count}, as {SUMMARY} says"
        )
    return Run(file.parent.absolute(), summary, worlds)


def paired(a: Run, b: Run) -> bool:
    """Whether world i of both had the same random numbers: the same seed and the same worlds.

    So it may be another wall or picture: the robot starts with the same errors, slips and sees with the same
    noise, and resampling worlds in pairs is right whether or not that makes their scores alike.
    """
    if a.worlds is None or b.worlds is None or a.summary.get("seed") != b.summary.get("seed"):
        return False
    return np.array_equal(a.worlds.get("world", np.zeros(0)), b.worlds.get("world", np.ones(0)))


def option_differences(a: Run, b: Run) -> list[tuple[str, Any, Any]]:
    """Options whose values differ; None where a run has no such option."""
    first, second = a.summary["config"], b.summary["config"]
    names = dict.fromkeys([*first, *second])
    return [
        (name, first.get(name), second.get(name)) for name in names if first.get(name) != second.get(name)
    ]


def compare(a: Run, b: Run, seed: int = 0) -> list[Row]:
    """All figures that both summaries have, in the order of a's."""
    first, second = dict(figures(a.summary)), dict(figures(b.summary))
    for name in [*first, *second]:  # a status that never occurred is counted zero times
        if name.startswith(_COUNTS):
            first.setdefault(name, 0)
            second.setdefault(name, 0)
    random = np.random.default_rng(seed)
    picks = _picks(a, b, random)
    rows = []
    for name in first:
        if name in second:
            x, y = first[name], second[name]
            difference = None if x is None or y is None else y - x
            rows.append(Row(name, x, y, difference, *_interval(name, a, b, picks)))
    return rows


def figures(summary: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, float | None]]:
    """Every number of a summary by its path of keys; a row of a list goes by its name and variant."""
    for key, value in summary.items():
        name = f"{above}{key}"
        if not above and key in _NO_FIGURES:
            continue
        if isinstance(value, Mapping):
            yield from figures(value, f"{name}.")
        elif isinstance(value, list):
            for entry in value:
                if isinstance(entry, Mapping) and "name" in entry:
                    labels = [str(entry[k]) for k in ("study", "name", "variant") if k in entry]
                    yield from figures(entry, f"{name}[{', '.join(labels)}].")
        elif value is None or (isinstance(value, int | float) and not isinstance(value, bool)):
            yield name, value


def _picks(a: Run, b: Run, random: np.random.Generator) -> tuple[np.ndarray, np.ndarray] | None:
    """Worlds of each resample; the same in both where the runs are paired."""
    if not a.worlds or not b.worlds:
        return None
    sizes = [len(next(iter(run.worlds.values()))) for run in (a, b) if run.worlds]
    if min(sizes) < 2:
        return None
    first = random.integers(sizes[0], size=(RESAMPLES, sizes[0]))
    return first, first if paired(a, b) else random.integers(sizes[1], size=(RESAMPLES, sizes[1]))


def _interval(
    name: str, a: Run, b: Run, picks: tuple[np.ndarray, np.ndarray] | None
) -> tuple[float | None, float | None]:
    """Percentiles of b - a over resamples of the worlds; None where a figure has no column, or no value."""
    statistic = STATISTICS.get(name)
    if statistic is None or picks is None:
        return None, None
    first, second = _column(a, statistic), _column(b, statistic)
    if first is None or second is None:
        return None, None
    middle = np.mean if statistic.mean else np.median
    with np.errstate(invalid="ignore"):
        difference = middle(second[picks[1]], axis=1) - middle(first[picks[0]], axis=1)
    if not np.isfinite(difference).all():
        return None, None
    low, high = np.quantile(difference, (0.025, 0.975)).tolist()
    return low, high


def _column(run: Run, statistic: _Statistic) -> np.ndarray | None:
    worlds = run.worlds or {}
    if statistic.column not in worlds or "status" not in worlds:
        return None
    values = np.asarray(worlds[statistic.column], float)
    status = np.asarray(worlds["status"])
    lost = ~np.isfinite(values)
    if statistic.error:
        lost |= status != "ok"
    if statistic.column == "coverage":
        lost |= status == "diverged"  # what was painted before is no achievement
    return np.where(lost, statistic.missing, values)


class _NoNumber(ValueError):
    """JSON that Python reads and that is no number to compute with."""


def _finite(word: str) -> float:
    if not math.isfinite(float(word)):
        raise _NoNumber(f"the number {word}")
    return float(word)


def _whole(word: str) -> int:
    try:
        _finite(word)
    except _NoNumber:
        raise _NoNumber(f"a number of {len(word)} digits") from None
    return int(word)


def _read_worlds(path: Path, option: str) -> dict[str, np.ndarray] | None:
    """Columns of runs.parquet, numbers as float64 with NaN for null; None where there is no file."""
    if not path.is_file():
        return None
    import pyarrow as pa
    import pyarrow.parquet as pq

    def refuse(cause: str) -> InputError:
        return InputError(f"{option}: found {path} ({cause}), allowed: the runs.parquet of the run")

    try:
        table = pq.read_table(path)
        columns = {
            name: table[name].to_numpy().astype(object if pa.types.is_string(table[name].type) else float)
            for name in table.column_names
            if pa.types.is_string(table[name].type) or pa.types.is_primitive(table[name].type)
        }
    except (OSError, pa.ArrowException) as error:
        raise refuse("not Parquet") from error
    except (TypeError, ValueError) as error:
        raise refuse("a column that is neither numbers nor text") from error
    figures_of = {"world", *(statistic.column for statistic in STATISTICS.values())}
    for name, column in columns.items():
        if name in figures_of and column.dtype == object:
            raise refuse(f"text in the column {name}")
        if name == "status" and column.dtype != object:
            raise refuse("numbers in the column status")
    return columns
