"""The command line: one line for every error, the exit status, nothing left behind."""

import json
import subprocess
import sys
import types
from pathlib import Path

import pytest

from experiments import commands, process
from experiments.cli import main
from experiments.report import Page
from experiments.report import paint as report
from jaxpaint.errors import InputError

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(autouse=True)
def elsewhere(tmp_path, monkeypatch):
    """Every test runs in a folder of its own."""
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def pipeline(monkeypatch, made_up):
    """Replaces the painting pipeline; the options of every call, and what to raise instead of a result."""
    held = types.SimpleNamespace(options=[], error=None, outcome=made_up)

    def run(options, progress):
        held.options.append(options)
        if held.error is not None:
            raise held.error
        with progress("paint", 2) as bar:
            bar.describe("compiling")
            bar.advance()
        return held.outcome

    monkeypatch.setitem(sys.modules, "experiments.paint", types.SimpleNamespace(run=run))
    # Figures take seconds; their own tests draw them.
    monkeypatch.setattr(report, "build_page", lambda *_: Page("jaxpaint paint", "painted"))
    return held


BAD = {
    "": "command",
    "pain": "pain",
    "paint --colour red": "--colour",
    "paint --worlds": "--worlds",
    "paint --worlds 0": "--worlds",
    "paint --worlds -3": "--worlds",
    "paint --worlds 2.5": "--worlds",
    "paint --worlds many": "--worlds",
    "paint --worlds=": "--worlds",
    "paint --speed -1": "--speed",
    "paint --speed 0": "--speed",
    "paint --speed inf": "--speed",
    "paint --brush-radius nan": "--brush-radius",
    "paint --wall-scale 0": "--wall-scale",
    "paint --wall-height -1": "--wall-height",
    "paint --theta nan": "--theta",
    "paint --dwell -1": "--dwell",
    "paint --seed -1": "--seed",
    "paint --seed 99999999999": "--seed",
    "paint --canvas-size 1": "--canvas-size",
    "paint --canvas-size 1 0": "--canvas-size",
    "paint --canvas-size 1 2 3": "3",
    "paint --canvas-pose 0 0 nan 0": "--canvas-pose",
    "paint --up w": "--up",
    "paint --up -w": "--up",
    "paint --friction 0.5": "beside --fidelity wheeled",
    "paint --fidelity wheeled --friction 0": "above 0",
    "paint --refine agn": "not built yet",
    "paint --fidelity hover": "--fidelity",
    "paint --controller pid": "acp, whole-body, trajectory",
    "paint --noise loud": "s1-simulation",
    "paint --wall moon": "flat, corner, cylinder",
    "paint --wall text.txt": "text.txt",
    "paint --image nowhere.svg": "nowhere.svg",
    "paint --image text.txt": "text.txt",
    "paint --robot text.txt": "--robot",
    "paint --variance-bounds 0.8 0.3": "--variance-bounds",
    "paint --wall flat --up=-y": "--up: found '-y' (no effect)",
    "paint --wall-scale 0.001": "beside a file as --wall",
    "paint --wall-height 3": "--wall-height",
    "paint --colours 2": "--colours: found '2' (no effect), allowed: only beside a PNG or JPEG",
    "paint --image used/a.svg --ink dark": "--ink",
    "paint --threshold global": "--threshold",
    "paint --line-art area": "--line-art",
    "paint --export-world 5": "--export-world",
    "paint --export": "--export: found 'nothing', allowed: none, or",
    "paint --export svg": "--export",
    "paint --export csv --export-world 64": "--export-world",
    "paint --record": "--record: found 'nothing', allowed: none, or",
    "paint --record 64": "--record: found '64', allowed: below --worlds (64)",
    "paint --record 1 2 1": "--record",
    "paint --record -1": "--record",
    "paint --record 1 two": "--record",
    "paint --no-halting --theta 0.3": "--theta",
    "paint --no-low-speed --low-speed-scale 2": "--low-speed-scale",
    "paint --chosen theta": "--chosen",
    "paint --config chosen.json": "chosen: found 'wall'",
    "paint --config unlisted.json": "chosen: found '7'",
    "paint --config nowhere.json": "nowhere.json",
    "paint --config text.txt": "text.txt",
    "paint --config other.json": "bench",
    "paint --config strange.json": "colour",
    "paint --config wrong.json": "--worlds",
    "paint --config newer.json": "written by jaxpaint 99.0",
    "paint --config broken.json": "not JSON",
    "reproduce --config nameless.json": "no name",
    "paint --out used": "used",
    "paint --out text.txt": "text.txt",
    "paint --out text.txt/below": "--out",
    "paint extra": "extra",
    "bench everything": "NAME",
    "reproduce everything": "NAME",
    "reproduce": "NAME",
    "compare": "A: found too few values",
    "compare used": "B: found too few values",
    "compare nowhere used": "nowhere",
    "compare used used": "A: found",
    "compare text.txt other.json": "not JSON",
    "compare wrong.json other.json": "a run of 'paint'",
    "compare strange.json list.json": "B: found",
    "compare other.json other.json other.json": "other.json",
    "view": "RUN: found too few values",
    "view nowhere": "nowhere",
    "view used": "used",
    "view text.txt": "not JSON",
    "view other.json": "a run of 'bench', allowed: a run of 'jaxpaint paint'",
    "view strange.json": "colour",
    "view wrong.json": "--worlds",
    "view unlisted.json": "chosen: found '7'",
    "view wrong.json --frames 0": "--frames",
    "view wrong.json --world -1": "--world",
    "view wrong.json --size 640": "--size",
    "view wrong.json --size 640 10": "--size",
    "view wrong.json --frames 1000 --size 4096 4096": "pixels in all",
}


@pytest.mark.parametrize("line", BAD)
def test_bad_usage_is_one_line_and_status_2(line, capsys, tmp_path, pipeline):
    (tmp_path / "text.txt").write_text("words")
    (tmp_path / "used").mkdir()
    (tmp_path / "used" / "mine").write_text("precious")
    (tmp_path / "used" / "a.svg").touch()
    (tmp_path / "other.json").write_text('{"command": "bench", "config": {}}')
    (tmp_path / "strange.json").write_text('{"command": "paint", "config": {"colour": 1}}')
    (tmp_path / "wrong.json").write_text('{"command": "paint", "config": {"worlds": [1]}}')
    newer = {"command": "paint", "config": {"colour": 1}, "versions": {"jaxpaint": "99.0"}}
    (tmp_path / "newer.json").write_text(json.dumps(newer))
    (tmp_path / "broken.json").write_text('{"command": "paint", "config": {')
    (tmp_path / "list.json").write_text("[1]")
    for name, chosen in (("chosen", ["theta", "wall"]), ("unlisted", 7)):
        summary = {"command": "paint", "config": {}, "chosen": chosen}
        (tmp_path / f"{name}.json").write_text(json.dumps(summary))
    (tmp_path / "nameless.json").write_text('{"command": "reproduce", "config": {}}')
    before = sorted(tmp_path.rglob("*"))
    assert main(line.split()) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert len(said.err.splitlines()) == 1
    assert BAD[line] in said.err
    assert "Traceback" not in said.err
    assert "allowed" in said.err
    assert sorted(tmp_path.rglob("*")) == before
    assert pipeline.options == []


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


def paint(line: str) -> int:
    return main(["paint", *line.split()])


@pytest.fixture
def capture(tmp_path) -> str:
    """A captured wall that nobody reads."""
    (tmp_path / "wall.pcd").touch()
    return "--wall wall.pcd"


def test_config_repeats_a_run_with_what_is_given_on_top(pipeline, capture):
    first_line = (
        f"paint --worlds 5 --speed 0.05 {capture} --up -y --canvas-pose 0 -1 1.2 0.1 --seed 9 --out a"
    )
    second_line = "paint --config a/summary.json --speed 0.04 --out b"
    assert main(first_line.split()) == 0
    assert main(second_line.split()) == 0
    first, second = pipeline.options
    assert second.worlds == 5
    assert second.seed == 9
    assert second.up == "-y"
    assert second.canvas_pose == (0.0, -1.0, 1.2, 0.1)
    assert second.speed == 0.04
    assert second.theta == pipeline.outcome.resolved["theta"]
    assert first.speed == 0.05


def test_what_the_program_chose_is_dropped_with_what_it_was_chosen_by(pipeline, tmp_path, capture):
    """The pipeline chose canvas_size and theta."""
    assert paint("--wall corner --dwell 0.7 --out a") == 0
    assert json.loads((tmp_path / "a" / "summary.json").read_text())["chosen"] == ["canvas_size", "theta"]
    again = "--config a/summary.json"
    both = ("canvas_size", "theta")
    for line, size, theta, chosen in (
        ("", (2.4, 0.8), 0.4, both),
        ("--wall corner", (2.4, 0.8), 0.4, both),
        ("--wall flat", None, 0.4, ("theta",)),
        ("--wall flat --canvas-size 1 2", (1.0, 2.0), 0.4, ("theta",)),
        ("--halting --theta 0.4", (2.4, 0.8), 0.4, ("canvas_size",)),
    ):
        assert paint(f"{again} {line}") == 0
        options = pipeline.options[-1]
        assert (options.canvas_size, options.theta, options.chosen) == (size, theta, chosen), line
        assert options.dwell == 0.7, "given to the first run"
    assert paint(f"{again} {capture} --no-halting") == 0
    options = pipeline.options[-1]
    assert (options.canvas_size, options.theta, options.dwell, options.chosen) == (None, None, None, ())


def test_a_repeat_on_another_wall_drops_what_only_a_captured_one_needs(pipeline, capture, tmp_path):
    (tmp_path / "photo.png").touch()
    given = f"{capture} --up -y --wall-scale 0.001 --wall-height 0.5 --image photo.png --colours 2"
    assert main(f"paint {given} --export csv --export-world 3 --out a".split()) == 0
    assert paint("--config a/summary.json --wall flat --export none --out b") == 0
    options = pipeline.options[-1]
    assert (options.up, options.wall_scale, options.wall_height) == (None, 1.0, None)
    assert (options.export, options.export_world, options.colours) == ((), 0, 2)
    (tmp_path / "line.svg").touch()
    assert paint("--config a/summary.json --image line.svg --out c") == 0
    options = pipeline.options[-1]
    assert (options.up, options.colours, options.export_world) == ("-y", 0, 3)
    assert paint("--config a/summary.json --wall flat --up -y") == 2


def test_a_repeat_of_a_repeat_still_knows_what_was_chosen(pipeline, tmp_path):
    assert paint("--out a") == 0
    assert paint("--config a/summary.json --out b") == 0
    first, second = (json.loads((tmp_path / name / "summary.json").read_text()) for name in "ab")
    assert first["chosen"] == second["chosen"] == ["canvas_size", "theta"]
    assert first["config"] == second["config"]


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
    import dataclasses

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
