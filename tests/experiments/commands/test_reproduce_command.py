"""`jaxpaint reproduce` from made-up studies: summary, report, pictures."""

import json
import sys
import types

import pytest
from matplotlib.figure import Figure

from experiments.cli import main
from experiments.commands import reproduce
from experiments.reproduce import ReproduceResult, Row


@pytest.fixture
def studies(monkeypatch, tmp_path):
    """Two studies; the seeds they were run with."""
    monkeypatch.chdir(tmp_path)
    seeds = []

    def run(settings):
        seeds.append(settings.seed)
        rows = [Row("RMSE", "ours", 0.024, 0.004, 0.003, 0.005), Row("RMSE", "literal", None, float("nan"))]
        return ReproduceResult.of(rows, {"a view": Figure(figsize=(2, 1))})

    monkeypatch.setattr(reproduce, "REPRODUCTIONS", {"one": "made_up_one", "two": "made_up_two"})
    monkeypatch.setattr(reproduce, "load", lambda name: sys.modules[f"made_up_{name}"])
    for name in ("one", "two"):
        monkeypatch.setitem(sys.modules, f"made_up_{name}", types.SimpleNamespace(run=run))
    return seeds


def test_all_studies_go_into_one_table(studies, tmp_path, capsys):
    assert main(["reproduce", "all", "--out", "here", "--seed", "4"]) == 0
    assert studies == [4, 4]
    summary = json.loads((tmp_path / "here" / "summary.json").read_text(), parse_constant=pytest.fail)
    assert summary["command"] == "reproduce"
    assert [row["study"] for row in summary["table"]] == ["one", "one", "two", "two"]
    first, second = summary["table"][:2]
    assert {key: first[key] for key in ("name", "variant", "published", "ours", "low", "high")} == {
        "name": "RMSE", "variant": "ours", "published": 0.024, "ours": 0.004, "low": 0.003, "high": 0.005,
    }  # fmt: skip
    assert (second["published"], second["ours"]) == (None, None)
    assert "0.0240" in capsys.readouterr().out
    names = ["one-a-view.png", "report.html", "summary.json", "two-a-view.png"]
    assert sorted(entry.name for entry in (tmp_path / "here").iterdir()) == names
    html = (tmp_path / "here" / "report.html").read_text()
    assert html.count("<img") == 2
    assert "http" not in html


def test_what_is_measured_needs_its_data_and_all_goes_without(studies, tmp_path, monkeypatch):
    monkeypatch.setattr(reproduce, "MEASURED", ("two",))
    monkeypatch.setattr("experiments.sensing.missing_file", lambda folder: None)
    assert main(["reproduce", "all", "--out", "without"]) == 0
    summary = json.loads((tmp_path / "without" / "summary.json").read_text())
    assert {row["study"] for row in summary["table"]} == {"one"}
    assert summary["left_out"] == ["two"]
    assert main(["reproduce", "all", "--data", str(tmp_path), "--out", "with"]) == 0
    summary = json.loads((tmp_path / "with" / "summary.json").read_text())
    assert {row["study"] for row in summary["table"]} == {"one", "two"}
    assert summary["left_out"] == []
    assert summary["config"]["data"] == str(tmp_path)


def test_every_study_of_the_registry_can_be_asked_for():
    from experiments.options import values_of
    from experiments.reproduce import REPRODUCTIONS, load

    names = values_of(reproduce.ReproduceOptions)["name"]
    assert names is not None
    for name in (*REPRODUCTIONS, "all"):
        assert names.holds(name)
    for name in REPRODUCTIONS:
        assert callable(load(name).run)
