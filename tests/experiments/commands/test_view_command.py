"""`jaxpaint view`: files, summary, exit status, with and without OpenGL."""

import json
import os

import pytest

from experiments import viewing
from experiments.cli import main
from experiments.viewing.opengl import MISSING

FILES = ["model.xml", "play.py", "trajectory.npz"]


@pytest.fixture
def view(recorded_run, tmp_path, monkeypatch):
    """Runs `jaxpaint view` on the recorded run; drawing is only noted. Exit status and summary."""
    monkeypatch.chdir(tmp_path)

    def note(folder, path, frames, size, environment):
        path.write_text(f"{frames} of {size} by {environment['MUJOCO_GL']}")

    def run(*words: str, opengl: bool = True, draw=note):
        monkeypatch.setattr(viewing, "draw_film", draw)
        monkeypatch.setattr(viewing, "find_opengl", lambda: {"MUJOCO_GL": "egl"} if opengl else None)
        status = main(["view", str(recorded_run), "--out", "here", "--overwrite", *words])
        path = tmp_path / "here" / "summary.json"
        return status, json.loads(path.read_text()) if path.exists() else None

    return run


def test_a_view_of_the_first_world(view, recorded_run, tmp_path, capsys):
    status, summary = view()
    assert status == 0
    common = ["command", "config", "seed", "versions", "device", "compile_s", "run_s"]
    assert list(summary)[: len(common)] == common
    assert {"run", "world", "frames", "files", "notes"} <= set(summary)
    assert summary["run"] == str(recorded_run)
    assert (summary["world"], summary["frames"], summary["notes"]) == (3, 6, [])
    assert (summary["config"]["world"], summary["config"]["frames"]) == (3, 6)
    assert summary["files"] == ["film.png", *FILES, "summary.json"]
    assert (tmp_path / "here" / "film.png").read_text() == "6 of (720, 540) by egl"
    said = capsys.readouterr()
    assert str(tmp_path / "here" / "play.py") in said.out
    assert said.err == ""


def test_without_opengl_the_other_files_are_there(view, capsys):
    status, summary = view(opengl=False)
    assert status == 0
    assert summary["files"] == [*FILES, "summary.json"]
    assert (summary["frames"], summary["notes"]) == (0, [MISSING])
    said = capsys.readouterr()
    assert MISSING in said.out
    assert said.err == ""


def test_frames_that_were_asked_for_and_not_drawn_are_a_failure(view, tmp_path, capsys):
    status, summary = view("--frames", "2", opengl=False)
    assert status == 1
    assert summary["notes"] == [MISSING]
    assert capsys.readouterr().err == f"jaxpaint view: failed: {MISSING}\n"


def test_a_drawing_that_breaks_loses_nothing_else(view):
    def crash(folder, path, *_):
        path.write_text("half")
        raise RuntimeError("film.png is not drawn: out of memory")

    status, summary = view(draw=crash)
    assert status == 1
    assert summary["files"] == [*FILES, "summary.json"]
    assert "out of memory" in summary["notes"][0]


def test_a_repeat_has_not_asked_where_the_first_run_did_not(view, tmp_path):
    assert view(opengl=False)[0] == 0
    again = (tmp_path / "here" / "summary.json").rename(tmp_path / "first.json")
    assert view("--config", str(again), opengl=False)[0] == 0
    assert view("--config", str(again), "--frames", "6", opengl=False)[0] == 1
    assert view("--config", str(again), "--frames", "3", "--size", "320", "200")[1]["frames"] == 3


def test_a_world_that_is_not_recorded_leaves_nothing(view, capsys):
    assert view("--world", "2") == (2, None)
    said = capsys.readouterr()
    assert len(said.err.splitlines()) == 1
    assert "--world: found 2 (not recorded), allowed: 3 1" in said.err


def test_the_users_choice_of_opengl_is_left_alone(view, monkeypatch):
    monkeypatch.setenv("MUJOCO_GL", "osmesa")
    assert view()[0] == 0
    assert os.environ["MUJOCO_GL"] == "osmesa"
    monkeypatch.delenv("MUJOCO_GL")
    assert view()[0] == 0
    assert "MUJOCO_GL" not in os.environ
