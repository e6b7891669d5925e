"""A run repeated from its summary is the same, bit for bit."""

import json
from pathlib import Path

import jax
import numpy as np
import pytest

from experiments import viewing
from experiments.cli import main, parse
from experiments.commands.paint import COMMAND
from experiments.commands.running import chosen_options
from experiments.options import to_config
from experiments.output import write_json
from experiments.placing import placed
from experiments.resolving import resolved
from experiments.viewing import play
from jaxpaint.decisions.thresholds import default_thresholds

PICTURE = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 60 60" fill="none" stroke="black">
<path d="M5 10 H40"/><path d="M5 30 Q25 50 50 30"/></svg>"""
# A plate with a bend: what is up, how high it stands and where the canvas lies is left to the program.
PLATE = """v 0 0 0
v 2 0 0
v 2 1.1 0
v 0 1.1 0
v 2.1 0 .1
v 2.1 1.1 .1
f 1 2 3
f 1 3 4
f 2 5 6
f 2 6 3
"""
# What the clock and what is free say, and nothing else, differs from run to run.
CLOCKED = ("compile_s", "run_s", "steps_per_s", "memory")


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """A short run with something that is switched off, and its repetition."""
    folder = tmp_path_factory.mktemp("runs")
    (folder / "two.svg").write_text(PICTURE)
    (folder / "plate.obj").write_text(PLATE)
    first = f"--image {folder}/two.svg --canvas-size 0.5 0.5 --no-halting --worlds 4 --seed 11"
    first += f" --record 2 0 --out {folder}/a"
    again = f"--config {folder}/a/summary.json --out {folder}/b"
    assert main(["paint", *first.split()]) == 0
    assert main(["paint", *again.split()]) == 0
    return folder


def written(line: str, folder: Path):
    """The options of a command line, its wall, and the summary.json of a run that painted nothing."""
    options = parse(COMMAND, line.split())
    options.check()
    place = placed(options)
    chosen = resolved(options, place.found)
    config = {**to_config(options), **chosen}
    summary = {"command": "paint", "config": config, "chosen": chosen_options(options, chosen)}
    path = folder / "summary.json"
    write_json(path, summary)
    return options, place, json.loads(path.read_text())


@pytest.mark.parametrize(
    "line",
    [
        "",
        "--wall corner --canvas-size 0.3 0.2",
        "--no-low-speed",
        "--no-halting --controller whole-body",
        "--theta 0.1 --variance-bounds 0.1 0.2",
        "--brush-radius 0.002",
        "--brush-radius 0.002 --bleed 0.1",
        "--export csv ros2-json --export-world 3",
        "--wall plate.obj",
        "--wall plate.obj --up +y",
        "--wall plate.obj --wall-height 0.7 --canvas-size 0.7 0.3",
        "--wall plate.obj --canvas-pose -0.1 0.2 1.1 0",
        "--wall plate.obj --no-halting --no-low-speed",
    ],
)
def test_what_is_resolved_is_a_fixed_point(line, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plate.obj").write_text(PLATE)
    options, place, first = written(line, tmp_path)
    again, same_place, second = written("--config summary.json", tmp_path)
    assert first == second
    for a, b in zip(
        jax.tree.leaves((place.scene, place.canvas)),
        jax.tree.leaves((same_place.scene, same_place.canvas)),
        strict=True,
    ):
        np.testing.assert_array_equal(a, b)
    assert place.notes == same_place.notes
    limits = (default_thresholds(**o.threshold_changes()) for o in (options, again))
    assert jax.tree.reduce(lambda x, y: x and y, jax.tree.map(np.array_equal, *limits))
    open_still = {name for name, value in first["config"].items() if value is None}
    off = {"theta", "dwell", "release_margin"} if "--no-halting" in line else set()
    off |= {"low_speed_scale"} if "--no-low-speed" in line else set()
    assert open_still == {"image", "robot", *off} | (set() if "plate" in line else {"up", "wall_height"})


def test_a_value_that_is_edited_counts(tmp_path, monkeypatch):
    """Though the summary says that the program chose it."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plate.obj").write_text(PLATE)
    _, _, first = written("--wall plate.obj", tmp_path)
    assert {"up", "wall_height", "canvas_size", "canvas_pose"} <= set(first["chosen"])
    config = {**first["config"], "up": "-y", "canvas_size": [0.5, 0.25]}
    write_json(tmp_path / "summary.json", {**first, "config": config})
    _, place, second = written("--config summary.json", tmp_path)
    assert "up -y" in " ".join(place.notes)
    np.testing.assert_allclose(place.canvas.size, (0.5, 0.25))
    assert second["config"] == config


def test_every_key_but_the_clock_is_the_same(runs):
    first, second = (json.loads((runs / name / "summary.json").read_text()) for name in "ab")
    assert list(first) == list(second)
    for key in first:
        if key not in CLOCKED:
            assert first[key] == second[key], key
    assert first["seed"] == 11


def test_every_array_is_the_same(runs):
    assert (runs / "a" / "runs.parquet").read_bytes() == (runs / "b" / "runs.parquet").read_bytes()
    with np.load(runs / "a" / "trajectories.npz") as a, np.load(runs / "b" / "trajectories.npz") as b:
        assert set(a) == set(b)
        for name in a:
            np.testing.assert_array_equal(a[name], b[name], err_msg=name)


def test_the_worlds_that_were_asked_for_are_recorded_and_can_be_viewed(runs, monkeypatch):
    with np.load(runs / "a" / "trajectories.npz") as found:
        assert found["world"].tolist() == [2, 0]
        live = np.isfinite(found["time"][0])
        assert set(found["stroke"][0][live]) == {-1, 0, 1}
    monkeypatch.setattr(viewing, "find_opengl", lambda: None)
    assert main(["view", str(runs / "a"), "--world", "2", "--out", str(runs / "view")]) == 0
    model, motion = play.load(runs / "view")
    assert float(play.check(model, motion).split("within ")[1].split()[0]) < 0.1, "mm from the run's brush"
    assert len(motion["time"]) == live.sum()


def test_compared_with_itself_nothing_differs(runs):
    assert main(["compare", str(runs / "a"), str(runs / "b"), "--out", str(runs / "c")]) == 0
    found = json.loads((runs / "c" / "summary.json").read_text())
    assert found["paired"] is True
    assert found["options"] == []
    named = {row["name"]: row for row in found["rows"] if row["name"] not in CLOCKED}
    assert {row["difference"] for row in named.values()} <= {0, None}
    rmse = named["tracking_rmse.total"]
    assert (rmse["low"], rmse["high"]) == (0, 0)
