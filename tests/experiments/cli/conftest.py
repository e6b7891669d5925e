"""The program with a pipeline that does nothing, in a folder of its own."""

import sys
import types

import pytest

from experiments.report import Page
from experiments.report import paint as report


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


@pytest.fixture
def capture(tmp_path) -> str:
    """A captured wall that nobody reads."""
    (tmp_path / "wall.pcd").touch()
    return "--wall wall.pcd"
