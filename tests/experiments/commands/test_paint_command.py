"""What the pipeline hands back is complete."""

import dataclasses
import json
import sys
import types

import numpy as np
import pyarrow.parquet as pq
import pytest

from experiments.cli import main
from experiments.commands.paint import result_table
from experiments.commands.paint_options import PaintOptions
from experiments.output import write_parquet
from experiments.report import Page
from experiments.report import paint as report
from experiments.report.scores import SCORES, score_table
from experiments.tables import as_text
from sims.painting.joint_plan import JointTrajectory


@pytest.mark.parametrize("key", ["tracking_rmse", "steps_per_s", "modes"])
def test_a_summary_without_a_key_of_the_contract_is_refused(made_up, key):
    summary = {name: value for name, value in made_up.summary.items() if name != key}
    with pytest.raises(ValueError, match=key):
        dataclasses.replace(made_up, summary=summary)


def test_a_key_below_is_missed_too(made_up):
    paint = {name: value for name, value in made_up.summary["paint"].items() if name != "excess"}
    with pytest.raises(ValueError, match=r"paint\.excess"):
        dataclasses.replace(made_up, summary={**made_up.summary, "paint": paint})


def test_the_table_is_short_and_in_units_a_person_reads(made_up):
    shown = as_text(result_table(PaintOptions(wall="corner"), made_up))
    for words in ("23 ok, 1 unreachable of 24 worlds", "3.7 mm", "98.1 %", "0.8 °", "on corner", "-y"):
        assert words in shown
    assert len(shown.splitlines()) < 20


def test_worlds_can_be_read_back(made_up, tmp_path):
    write_parquet(tmp_path / "runs.parquet", made_up.worlds)
    table = pq.read_table(tmp_path / "runs.parquet")
    assert table.num_rows == 24
    assert table["status"].to_pylist().count("unreachable") == 1
    assert table["tracking_rmse"].null_count == 1


def test_scores_over_worlds_leave_out_those_without(made_up):
    table = score_table(made_up.worlds)
    columns = {score.name: score.column for score in SCORES}
    assert [row[0] for row in table.rows] == [
        name for name, column in columns.items() if column in made_up.worlds
    ]
    name, unit, median, _, _, worst = table.rows[0]
    values = made_up.worlds["tracking_rmse"]
    assert (name, unit) == ("tracking RMSE", "mm")
    assert median == pytest.approx(1e3 * np.nanmedian(values))
    assert worst == pytest.approx(1e3 * np.nanmax(values))
    coverage = next(row for row in table.rows if row[0] == "coverage")
    assert coverage[-1] == pytest.approx(100 * np.nanmin(made_up.worlds["coverage"]))


STILL = np.zeros((2, 1))
PLAN = JointTrajectory(
    ("base_x",), ("m",), np.array([0.0, 1.0]), STILL, STILL, STILL, np.array([True, False])
)


@pytest.fixture
def painted(monkeypatch, tmp_path, made_up):
    """Runs `jaxpaint paint` with a pipeline that found this; the exit status and the summary."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(report, "build_page", lambda *_: Page("jaxpaint paint", "painted"))

    def paint(*words: str, **found):
        outcome = dataclasses.replace(made_up, **found)
        module = types.SimpleNamespace(run=lambda *_: outcome)
        monkeypatch.setitem(sys.modules, "experiments.paint", module)
        status = main(["paint", "--out", "here", "--overwrite", *words])
        return status, json.loads((tmp_path / "here" / "summary.json").read_text())

    return paint


def test_notes_and_exports_are_in_the_summary(painted):
    status, summary = painted("--export", "csv", "ros2-json", plan=PLAN)
    assert status == 0
    assert summary["notes"] == ["Up is taken to be -y."]
    assert summary["exported"] == ["trajectory.csv", "trajectory.json"]
    assert set(summary["exported"]) < set(summary["files"])


def test_a_refused_export_is_seen_by_a_script(painted, capsys):
    why = "no trajectory exported: world 0 is unreachable"
    status, summary = painted("--export", "csv", refused=why, notes=("up is guessed", why))
    assert status == 1
    assert capsys.readouterr().err == f"jaxpaint paint: failed: {why}\n"
    assert summary["notes"] == ["up is guessed", why]
    assert summary["exported"] == []
    status, summary = painted()
    assert (status, summary["exported"]) == (0, [])
