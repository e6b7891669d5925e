"""The script that goes with a view: frames, paint, and pictures."""

import os
import subprocess
import sys
import types

import mujoco
import numpy as np
import pytest
from PIL import Image

from experiments.viewing import draw_film, find_opengl, play


@pytest.fixture(scope="module")
def opengl():
    """The environment in which MuJoCo draws."""
    found = find_opengl()
    if found is None:
        pytest.skip("no OpenGL here: neither EGL nor OSMesa")
    return found


def test_the_check_goes_through_all_frames(view, tmp_path):
    """As a user runs it: from anywhere, without the project."""
    kept = {name: value for name, value in os.environ.items() if name not in ("MUJOCO_GL", "PYTHONPATH")}
    done = subprocess.run(
        [sys.executable, str(view / "play.py"), "--check"],
        cwd=tmp_path,
        env=kept,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert len(done.stdout.splitlines()) == 1
    assert "60 frames, 4.7 s" in done.stdout


def test_the_brush_of_the_model_is_where_the_runs_was(view):
    assert "within 0.00" in play.check(*play.load(view))


def test_paint_follows_the_strokes(view):
    _, run = play.load(view)
    pieces = play.lines(run)
    times = [piece[0] for piece in pieces]
    assert times == sorted(times)
    assert not [t for t in times if run["time"][20] <= t <= run["time"][40]], "nothing between the strokes"
    np.testing.assert_allclose(pieces[0][1], run["brush"][0])
    np.testing.assert_allclose(pieces[-1][2], run["brush"][59])
    assert {tuple(piece[3]) for piece in pieces} == {(0.1, 0.2, 0.6), (0.8, 0.1, 0.1)}
    one = np.array([0])
    assert play.lines({**run, "stroke": np.full(60, -1)}) == []
    assert play.lines({**run, "stroke": np.concatenate([one, np.full(59, -1)])}) == [], "a dot has no length"


def test_long_ways_are_drawn_in_few_pieces():
    way = np.column_stack([np.arange(50_000) * 1e-3, np.zeros((50_000, 2))])
    run = {
        "time": np.arange(50_000.0),
        "brush": way,
        "stroke": np.zeros(50_000, int),
        "colour": np.zeros(50_000, int),
        "palette": np.zeros((1, 3)),
        "brush_radius": np.array(1e-3),
    }
    pieces = play.lines(run)
    assert len(pieces) < 4200
    np.testing.assert_allclose([p[2] for p in pieces[:-1]], [p[1] for p in pieces[1:]])


def test_a_scene_that_is_full_takes_no_more(view):
    model, run = play.load(view)
    scene = mujoco.MjvScene(model, 3)
    play.paint(scene, play.lines(run), 0.01)
    assert scene.ngeom == 3


def test_the_viewer_is_shown_the_run(view, monkeypatch):
    """With a viewer that is closed after three frames; the clock runs 100 s a frame."""
    model, run = play.load(view)
    seen = types.SimpleNamespace(frames=0, scene=mujoco.MjvScene(model, 1000), data=None)

    class Viewer:
        user_scn = seen.scene

        def __enter__(self):
            return self

        def __exit__(self, *_):
            pass

        lock = __enter__

        def is_running(self):
            return seen.frames < 3

        def sync(self):
            seen.frames += 1

    def launch_passive(_, data):
        seen.data = data
        viewer = Viewer()
        viewer.lock = Viewer
        return viewer

    monkeypatch.setitem(sys.modules, "mujoco.viewer", types.SimpleNamespace(launch_passive=launch_passive))
    monkeypatch.setattr(mujoco, "viewer", sys.modules["mujoco.viewer"], raising=False)
    clock = iter(range(0, 10_000, 100))
    monkeypatch.setattr(play.time, "monotonic", lambda: float(next(clock)))
    play.play(model, run, 1.0)
    assert seen.scene.ngeom == len(play.lines(run)), "all paint, once"
    np.testing.assert_allclose(seen.data.qpos, run["qpos"][-1])


def test_a_film_strip(view, tmp_path, opengl):
    draw_film(view, tmp_path / "film.png", 5, (160, 120), opengl)
    pixels = np.asarray(Image.open(tmp_path / "film.png")).astype(int)
    assert pixels.shape == (240, 480, 3), "three columns"
    first, last = pixels[:120, :160], pixels[120:, 160:320]
    assert first.std() > 10
    assert np.abs(first[30:] - last[30:]).max() > 100, "the robot moved"
    red = (last[..., 0] - last[..., 1] > 60) & (last[..., 0] - last[..., 2] > 60)
    assert red.sum() > 5, "the second stroke's paint"
    assert (pixels[120:, 320:] == 255).all(), "no sixth picture"


def test_what_goes_wrong_is_told(view, tmp_path, opengl):
    with pytest.raises(RuntimeError, match=r"film.png is not drawn: .*No such file"):
        draw_film(view, tmp_path / "nowhere" / "film.png", 1, (64, 64), opengl)
