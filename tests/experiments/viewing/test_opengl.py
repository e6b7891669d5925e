"""Finding OpenGL: what the user chose counts, and a broken one does no harm."""

import os
import sys

import pytest

from experiments.viewing import opengl


def test_the_users_choice_comes_first():
    assert opengl.kinds_to_try({}, "linux") == ("egl", "osmesa")
    assert opengl.kinds_to_try({"MUJOCO_GL": ""}, "linux") == ("egl", "osmesa")
    assert opengl.kinds_to_try({"MUJOCO_GL": "glfw"}, "linux") == (None,)
    assert opengl.kinds_to_try({}, "darwin") == (None,)


def test_the_first_that_works_is_taken(monkeypatch):
    monkeypatch.setattr(sys, "platform", "linux")
    tried = []

    def works(environment):
        tried.append(environment["MUJOCO_GL"])
        return tried[-1] == "osmesa"

    monkeypatch.setattr(opengl, "_works", works)
    assert opengl.find_opengl({"PATH": "/bin"}) == {"PATH": "/bin", "MUJOCO_GL": "osmesa"}
    assert tried == ["egl", "osmesa"]
    assert opengl.find_opengl({"MUJOCO_GL": "egl"}) is None


@pytest.mark.parametrize(
    "end", ["raise SystemExit(1)", "import os; os.abort()", "import time; time.sleep(60)"]
)
def test_a_process_that_ends_or_hangs_is_no_opengl(monkeypatch, end):
    monkeypatch.setattr(opengl, "_PROBE", end)
    monkeypatch.setattr(opengl, "_PATIENCE", 3.0)
    before = dict(os.environ)
    assert opengl.find_opengl({**before, "MUJOCO_GL": "egl"}) is None
    assert dict(os.environ) == before


def test_what_is_missing_is_named():
    assert "libegl1 libegl-mesa0 libgl1-mesa-dri" in opengl.MISSING
    assert "libosmesa6" in opengl.MISSING
