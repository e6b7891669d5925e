"""Two runs side by side: what differs, and how sure that is."""

import dataclasses
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from experiments import comparison
from experiments.comparison import STATISTICS, compare, option_differences, paired, read_run
from experiments.output import write_json, write_parquet
from experiments.paint import COLUMNS
from jaxpaint.errors import InputError
from sims.scoring import WorldScore, summarise

WORLDS = 64


def write_run(folder, *, seed=0, shift=0.0, worlds=WORLDS, broken=0, command="paint", **config):
    """A run whose world i has the tracking error 4 mm + what is peculiar to that world + shift."""
    folder.mkdir()
    random = np.random.default_rng(seed)
    own = random.normal(0, 1e-3, worlds)
    jitter = np.random.default_rng(99 + seed).normal(0, 1e-6, worlds)
    rmse = 4e-3 + own + shift + (jitter if shift else 0)
    status = np.where(np.arange(worlds) < broken, "diverged", "ok")
    coverage = np.where(status == "ok", 0.98 + own, 0.9)
    columns = {
        "world": np.arange(worlds), "seed": np.full(worlds, seed), "status": status,
        "tracking_rmse": np.where(status == "ok", rmse, np.nan), "coverage": coverage, "duration": 100 + own,
    }  # fmt: skip
    write_parquet(folder / "runs.parquet", columns)
    summary = {
        "command": command, "config": {"worlds": worlds, "wall": "flat", **config}, "seed": seed,
        "versions": {"numpy": "2"}, "compile_s": 1.5, "worlds": worlds, "status": {"ok": worlds - broken},
        "tracking_rmse": {"total": float(np.median(np.where(status == "ok", rmse, np.inf)))},
        "paint": {"coverage": float(np.median(np.where(status == "ok", coverage, 0)))},
        "duration": float(np.mean(columns["duration"])), "base_travel": None,
    }  # fmt: skip
    if broken:
        summary["status"]["diverged"] = broken
    write_json(folder / "summary.json", summary)
    return folder


@pytest.fixture
def runs(tmp_path):
    def make(first: dict, second: dict):
        return (
            read_run(write_run(tmp_path / "a", **first), "A"),
            read_run(write_run(tmp_path / "b", **second) / "summary.json", "B"),
        )

    return make


def row_of(rows, name) -> Any:
    return next(row for row in rows if row.name == name)


def test_a_small_shift_is_clear_in_paired_worlds_and_not_in_independent_ones(runs, tmp_path):
    a, b = runs({}, {"shift": 1e-4, "speed": 0.05})
    assert paired(a, b)
    row = row_of(compare(a, b), "tracking_rmse.total")
    assert row.difference == pytest.approx(1e-4, abs=5e-6)
    assert 0 < row.low < row.difference < row.high < 2e-4
    other = read_run(write_run(tmp_path / "c", shift=1e-4, seed=1), "B")
    assert not paired(a, other)
    row = row_of(compare(a, other), "tracking_rmse.total")
    assert row.low < 0 < row.high


def test_the_interval_of_independent_medians_is_as_wide_as_theory_says(runs):
    a, b = runs({"worlds": 400}, {"worlds": 400, "seed": 1})
    row = row_of(compare(a, b), "tracking_rmse.total")
    width = 2 * 1.96 * np.sqrt(2) * 1.2533 * 1e-3 / np.sqrt(400)  # of normal samples
    assert row.high - row.low == pytest.approx(width, rel=0.3)


def test_figures_are_those_of_the_summaries(runs):
    a, b = runs({}, {"broken": 3})
    rows = compare(a, b)
    names = [row.name for row in rows]
    assert len(set(names)) == len(names)
    assert not {"seed", "config.worlds"} & set(names)
    lost = row_of(rows, "status.diverged")
    assert (lost.a, lost.b, lost.difference) == (0, 3, 3)
    assert row_of(rows, "compile_s").low is None
    missing = row_of(rows, "base_travel")
    assert (missing.a, missing.difference, missing.low) == (None, None, None)
    assert row_of(rows, "paint.coverage").low is not None, "a failed world covers nothing: still a figure"


def test_half_of_the_worlds_lost_leaves_no_interval(runs):
    a, b = runs({}, {"broken": 40})
    row = row_of(compare(a, b), "tracking_rmse.total")
    assert (row.b, row.difference, row.low, row.high) == (None, None, None, None)


def test_the_same_seed_gives_the_same_intervals(runs):
    a, b = runs({}, {"seed": 3})
    assert compare(a, b, 5) == compare(a, b, 5)
    assert compare(a, b, 5) != compare(a, b, 6)


def test_options_that_differ_are_named(runs):
    a, b = runs({}, {"wall": "corner", "speed": 0.05})
    assert option_differences(a, b) == [("wall", "flat", "corner"), ("speed", None, 0.05)]


def test_rows_of_a_table_go_by_their_names(tmp_path):
    for name, value in (("a", 1.0), ("b", 3.0)):
        (tmp_path / name).mkdir()
        table = [{"study": "one", "name": "RMSE", "variant": v, "ours": value} for v in ("ours", "literal")]
        write_json(tmp_path / name / "summary.json", {"command": "reproduce", "config": {}, "table": table})
    rows = compare(read_run(tmp_path / "a", "A"), read_run(tmp_path / "b", "B"))
    assert [(row.name, row.difference) for row in rows] == [
        ("table[one, RMSE, ours].ours", 2.0),
        ("table[one, RMSE, literal].ours", 2.0),
    ]


def test_every_statistic_is_what_the_summary_says_of_its_column():
    """Of worlds that are fine, failed and without figures, as the pipeline writes them."""
    random = np.random.default_rng(2)
    names = [field.name for field in dataclasses.fields(WorldScore)]
    for statuses in (["ok"] * 7, ["ok"] * 5 + ["diverged", "unreachable"], ["ok", "diverged", "off-track"]):
        rows = []
        for k, status in enumerate(statuses):
            values = dict(zip(names, random.uniform(0.1, 0.9, len(names)), strict=True))
            values |= {"status": status, "halts": k**2, "control_steps": 10 * k}
            if k == len(statuses) - 1:
                values |= {"thickness_cv": math.nan, "coverage": math.nan, "rmse_x": math.nan}
            rows.append(WorldScore(**values))
        columns = {column: np.array([getattr(row, name) for row in rows]) for column, name in COLUMNS.items()}
        said = dict(comparison.figures(summarise(rows)))
        run = comparison.Run(Path(), {}, columns)
        for name, statistic in STATISTICS.items():
            column = comparison._column(run, statistic)
            assert column is not None, name
            middle = float((np.mean if statistic.mean else np.median)(column))
            assert (middle if math.isfinite(middle) else None) == said[name], name


def test_what_is_no_run_is_refused(tmp_path):
    (tmp_path / "summary.json").write_text(json.dumps({"command": "paint"}))
    with pytest.raises(InputError, match=r"^B: .*not the summary of a run"):
        read_run(tmp_path, "B")
    folder = write_run(tmp_path / "a")
    (folder / "runs.parquet").write_text("words")
    with pytest.raises(InputError, match=r"^A: .*not Parquet"):
        read_run(folder, "A")


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (
            lambda text: text.replace('"worlds": 64', '"worlds": 3'),
            "64 rows in .*allowed: 3, as summary.json says",
        ),
        (lambda text: text.replace('"compile_s": 1.5', '"compile_s": NaN'), "the number NaN"),
        (lambda text: text.replace('"compile_s": 1.5', '"compile_s": -Infinity'), "the number -Infinity"),
        (lambda text: text.replace('"compile_s": 1.5', '"compile_s": 1e999'), "the number 1e999"),
        (lambda text: text.replace('"compile_s": 1.5', '"compile_s": ' + "9" * 400), "of 400 digits"),
        (lambda text: text.replace('"compile_s": 1.5', '"compile_s": ' + "9" * 5000), "of 5000 digits"),
    ],
)
def test_a_damaged_summary_is_refused(change, said, tmp_path):
    file = write_run(tmp_path / "a") / "summary.json"
    file.write_text(change(file.read_text()))
    with pytest.raises(InputError, match=f"^A: found .*{said}"):
        read_run(tmp_path / "a", "A")


@pytest.mark.parametrize(
    ("name", "values"),
    [("coverage", ["much"] * WORLDS), ("status", np.arange(WORLDS)), ("world", ["first"] * WORLDS)],
)
def test_worlds_of_another_kind_are_refused(name, values, tmp_path):
    folder = write_run(tmp_path / "a")
    own = {"world": np.arange(WORLDS), "status": np.array(["ok"] * WORLDS), "coverage": np.ones(WORLDS)}
    write_parquet(folder / "runs.parquet", {**own, name: np.array(values)})
    with pytest.raises(InputError, match=f"^A: found .*in the column {name}"):
        read_run(folder, "A")


def test_worlds_before_another_wall_are_paired(runs):
    """They have the same random numbers."""
    a, b = runs({}, {"wall": "corner"})
    assert paired(a, b)
