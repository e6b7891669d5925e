"""`jaxpaint bench` from made-up benchmarks."""

import json

import pytest

from experiments.benchmarks import Bench, BenchRow
from experiments.cli import main
from experiments.commands import bench


@pytest.fixture(autouse=True)
def elsewhere(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)


def test_rows_are_ratios(monkeypatch, tmp_path, capsys):
    row = BenchRow("qp-box", 600.0, 20.0, "daqp")
    monkeypatch.setattr(bench, "BENCHMARKS", {"control": lambda: Bench([row])})
    assert main(["bench", "--out", "here"]) == 0
    summary = json.loads((tmp_path / "here" / "summary.json").read_text())
    assert summary["rows"] == [
        {"name": "qp-box", "ours": 600.0, "peer": 20.0, "peer_name": "daqp", "ratio": 30.0}
    ]
    assert "30.0" in capsys.readouterr().out


def test_a_missing_peer_is_named_with_its_extra(monkeypatch, tmp_path, capsys):
    def without_peer():
        raise ModuleNotFoundError("No module named 'daqp'", name="daqp")

    monkeypatch.setattr(bench, "BENCHMARKS", {"control": without_peer})
    assert main(["bench", "all"]) == 1
    said = capsys.readouterr().err
    assert "daqp" in said
    assert "extra 'bench'" in said
    assert list(tmp_path.iterdir()) == []
