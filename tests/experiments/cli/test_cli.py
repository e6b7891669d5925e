"""The command line: help, a whole folder or none, the exit status."""

import dataclasses
import json
import subprocess
import sys
from pathlib import Path

import pytest

from experiments import commands, process
from experiments.cli import main
from jaxpaint.errors import InputError

ROOT = Path(__file__).resolve().parents[3]


@pytest.mark.parametrize(
    "words",
    [["--help"], ["paint", "--help"], ["bench", "--help"], ["reproduce", "--help"], ["view", "--help"]],
)
def test_help_is_on_standard_output(words, capsys):
    assert main(words) == 0
    said = capsys.readouterr()
    assert said.err == ""
    assert all(name in said.out for name in (commands.MODULES if len(words) == 1 else ["--seed", "--out"]))


def test_help_of_paint_has_the_options_of_the_contract_with_units(capsys):
    main(["paint", "--help"])
    said = " ".join(capsys.readouterr().out.split())
    options = [
        *("image", "wall", "worlds", "fidelity", "refine", "controller", "up", "wall-scale", "wall-height"),
        *("canvas-size", "canvas-pose", "noise", "brush-radius", "speed", "robot", "config"),
        *("seed", "out", "overwrite"),
    ]
    assert all(f"--{name}" in said for name in options)
    assert "[m]" in said
    assert "[m/s]" in said
    assert "-s," not in said, "long options only"


def test_version(capsys):
    assert main(["--version"]) == 0
    assert capsys.readouterr().out.startswith("jaxpaint ")


def test_paint_writes_a_whole_folder_and_a_short_table(capsys, tmp_path, pipeline):
    assert main(["paint", "--worlds", "24", "--seed", "3"]) == 0
    said = capsys.readouterr()
    folder = tmp_path / "runs" / "paint-1"
    names = ["report.html", "runs.parquet", "summary.json", "trajectories.npz"]
    assert sorted(entry.name for entry in folder.iterdir()) == names
    assert sorted(entry.name for entry in (tmp_path / "runs").iterdir()) == ["paint-1"]
    assert "3.7 mm" in said.out
    assert str(folder / "report.html") in said.out
    assert len(said.out.splitlines()) < 25
    assert said.err == "", "no progress where standard error is no terminal"


def test_the_summary_has_the_keys_of_the_contract(tmp_path, pipeline):
    from experiments.commands.paint_outcome import SUMMARY_KEYS

    main(["paint", "--out", "here", "--seed", "3"])
    summary = json.loads((tmp_path / "here" / "summary.json").read_text(), parse_constant=pytest.fail)
    common = ["command", "config", "seed", "versions", "device", "compile_s", "run_s"]
    assert list(summary)[: len(common)] == common
    assert set(SUMMARY_KEYS) <= set(summary)
    assert summary["command"] == "paint"
    assert summary["seed"] == 3
    assert list(summary["versions"]) == ["jaxpaint", "jax", "mujoco", "mujoco-mjx", "numpy", "python"]
    assert summary["config"]["canvas_size"] == [2.4, 0.8], "as the pipeline resolved it"
    assert summary["compile_s"] >= 0
    assert summary["run_s"] >= 0
    assert "files" in summary


@pytest.mark.parametrize(
    ("words", "up"), [(["--up=-y"], "-y"), (["--up", "-y"], "-y"), (["--up", "+z"], "+z")]
)
def test_an_axis_may_start_with_a_sign(words, up, pipeline, capture):
    assert main(["paint", *capture.split(), *words]) == 0
    assert pipeline.options[0].up == up


def test_an_existing_folder_needs_overwrite(tmp_path, pipeline):
    assert main(["paint", "--out", "here"]) == 0
    assert main(["paint", "--out", "here"]) == 2
    assert main(["paint", "--out", "here", "--overwrite", "--seed", "5"]) == 0
    assert json.loads((tmp_path / "here" / "summary.json").read_text())["seed"] == 5


@pytest.mark.parametrize(
    ("error", "status", "message"),
    [
        (
            InputError("wall.pcd: found 3 points,\nallowed: 100 or more"),
            2,
            "wall.pcd: found 3 points, allowed",
        ),
        (RuntimeError("out of memory"), 1, "RuntimeError: out of memory"),
        (KeyboardInterrupt(), 130, "interrupted"),
    ],
)
def test_a_failure_leaves_nothing(error, status, message, capsys, tmp_path, pipeline):
    pipeline.error = error
    assert main(["paint", "--out", "deep/down"]) == status
    said = capsys.readouterr()
    assert len(said.err.splitlines()) == 1
    assert message in said.err
    assert list(tmp_path.iterdir()) == []


def test_no_painted_world_is_a_failure_with_results(capsys, tmp_path, pipeline, made_up):
    status = {"ok": 0, "unreachable": 24}
    pipeline.outcome = dataclasses.replace(made_up, summary={**made_up.summary, "status": status})
    assert main(["paint", "--out", "here"]) == 1
    assert "24 unreachable" in capsys.readouterr().err
    assert (tmp_path / "here" / "summary.json").exists()


def test_a_traceback_is_shown_when_asked_for(monkeypatch, pipeline):
    monkeypatch.setenv("JAXPAINT_TRACEBACK", "1")
    pipeline.error = RuntimeError("broken")
    with pytest.raises(RuntimeError):
        main(["paint"])


def test_calls_in_process_leave_the_process_alone(monkeypatch, pipeline):
    monkeypatch.setattr(process, "prepare_python", lambda: pytest.fail("set up"))
    monkeypatch.setattr(process, "prepare_jax", lambda: pytest.fail("set up"))
    assert main(["paint"]) == 0


def test_help_waits_for_no_heavy_library(tmp_path):
    code = (
        "import sys; from experiments.cli import main; status = main(['paint', '--help']);"
        "heavy = {'jax', 'matplotlib', 'mujoco', 'pyarrow', 'scipy'} & set(sys.modules);"
        "sys.exit(status or ', '.join(heavy) or 0)"
    )
    found = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert found.returncode == 0, found.stderr
