"""Progress is for those who watch."""

import sys
import time

import pytest

from experiments import progress


def test_nothing_is_shown_where_nobody_watches(capsys):
    with progress.progress("paint", 3) as bar:
        bar.describe("compile")
        bar.advance()
    assert capsys.readouterr() == ("", "")


@pytest.mark.parametrize("total", [4, None])
def test_a_bar_appears_for_long_work_only(monkeypatch, capsys, total):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setattr(progress, "PATIENCE", 30.0)
    with progress.progress("short", total) as bar:
        bar.advance()
    assert "short" not in capsys.readouterr().err
    monkeypatch.setattr(progress, "PATIENCE", 0.0)
    with progress.progress("long", total) as bar:
        bar.describe("longer")
        bar.advance()
        time.sleep(0.3)
    said = capsys.readouterr()
    assert "longer" in said.err
    assert said.out == ""
