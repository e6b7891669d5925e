"""`jaxpaint compare`: table, summary and page of two made-up runs."""

import base64
import io
import json
import re

import numpy as np
import pytest
from matplotlib.figure import Figure as MatplotlibFigure
from PIL import Image

from experiments.cli import main
from experiments.commands import compare
from experiments.output import write_json, write_parquet
from experiments.report import comparison
from experiments.report.style import look, to_png


@pytest.fixture
def runs(monkeypatch, tmp_path, made_up):
    monkeypatch.chdir(tmp_path)
    common = {"versions": {"numpy": "2"}, "device": "1 x cpu", "compile_s": 1.0, "run_s": 2.0}
    for name, slower in (("a", 1.0), ("b", 2.0)):
        (tmp_path / name).mkdir()
        worlds = {**made_up.worlds, "stroke_error": made_up.worlds["stroke_error"] * slower}
        summary = {**made_up.summary}
        middle = float(np.median(np.where(np.isnan(worlds["stroke_error"]), np.inf, worlds["stroke_error"])))
        paint = {**summary["paint"], "stroke_error": {"mean": middle, "p95": 0.006}}
        config = {"speed": 0.03 * slower, "wall": "flat"}
        write_json(
            tmp_path / name / "summary.json",
            {"command": "paint", "config": config, "seed": 3, **common, **summary, "paint": paint},
        )
        write_parquet(tmp_path / name / "runs.parquet", worlds)
        with look():
            picture = base64.b64encode(to_png(MatplotlibFigure(figsize=(2, slower)))).decode()
        (tmp_path / name / "report.html").write_text(f'<img alt="" src="data:image/png;base64,{picture}">')
    return tmp_path


def test_two_runs_side_by_side(runs, capsys):
    assert main(["compare", "a", "b/summary.json", "--out", "c"]) == 0
    said = capsys.readouterr()
    assert "--speed" in said.out
    assert "--wall" not in said.out
    assert "paired worlds" in said.out
    assert said.err == ""
    summary = json.loads((runs / "c" / "summary.json").read_text(), parse_constant=pytest.fail)
    assert list(summary)[:7] == ["command", "config", "seed", "versions", "device", "compile_s", "run_s"]
    assert summary["config"]["a"] == str(runs / "a")
    assert summary["paired"] is True
    assert summary["options"] == [{"name": "speed", "a": 0.03, "b": 0.06}]
    row = next(row for row in summary["rows"] if row["name"] == "paint.stroke_error.mean")
    assert list(row) == ["name", "a", "b", "difference", "low", "high"]
    assert row["difference"] == pytest.approx(row["b"] - row["a"])
    assert 0 < row["low"] <= row["difference"] <= row["high"]
    html = (runs / "c" / "report.html").read_text()
    assert re.findall("data:image/(png|svg)", html) == ["png", "svg"]
    assert "http" not in html


def test_without_worlds_and_pictures_the_figures_are_left(runs, capsys):
    for name in ("runs.parquet", "report.html"):
        (runs / "b" / name).unlink()
    assert main(["compare", "a", "b", "--out", "c"]) == 0
    assert "paired" not in capsys.readouterr().out
    rows = json.loads((runs / "c" / "summary.json").read_text())["rows"]
    assert rows
    assert all(row["low"] is None for row in rows)


def test_runs_of_two_commands_are_refused(runs, capsys):
    write_json(runs / "bench.json", {"command": "bench", "config": {}})
    assert main(["compare", "a", "bench.json"]) == 2
    assert "B: found a run of 'bench', allowed: a run of 'paint'" in capsys.readouterr().err
    assert not (runs / "runs").exists()


def test_a_comparison_is_repeated_from_its_own_summary(runs, capsys):
    assert main(["compare", "a", "b", "--out", "c", "--seed", "4"]) == 0
    again = ["compare", "a", "b", "--config", "c/summary.json", "--out", "d"]
    assert main(again) == 0
    first, second = (json.loads((runs / name / "summary.json").read_text()) for name in "cd")
    assert first["rows"] == second["rows"]
    assert second["seed"] == 4


def test_pictures_keep_their_order(runs):
    """A, which is red, is left of B."""
    for name, colour in (("a", (255, 0, 0)), ("b", (0, 0, 255))):
        with io.BytesIO() as file:
            Image.new("RGB", (80, 60), colour).save(file, "png")
            picture = base64.b64encode(file.getvalue()).decode()
        (runs / name / "report.html").write_text(f'<img alt="" src="data:image/png;base64,{picture}">')
    assert main(["compare", "a", "b", "--out", "c"]) == 0
    both = comparison.first_picture(compare.read_run(runs / "c", "C"))
    assert both is not None
    pixels = np.asarray(Image.open(io.BytesIO(both)).convert("RGB")).astype(int)
    red, blue = pixels[..., 0] - pixels[..., 2] > 200, pixels[..., 2] - pixels[..., 0] > 200
    middle = pixels.shape[1] // 2
    assert red.mean() > 0.1 and blue.mean() > 0.1
    assert not red[:, middle:].any() and not blue[:, :middle].any()
