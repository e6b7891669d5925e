"""The folder of a run is whole or absent."""

import json
import os

import pytest

from experiments.output import RunFolder
from jaxpaint.errors import InputError


@pytest.fixture(autouse=True)
def elsewhere(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def write(folder: RunFolder, **files: str) -> None:
    for name, text in files.items():
        folder.path(name).write_text(text)


def fail(run: RunFolder, error: type[BaseException]) -> None:
    with run as folder:
        write(folder, a="2")
        raise error


def be_late(run: RunFolder) -> None:
    """Another program makes the folder while the run goes on."""
    with run as folder:
        write(folder, a="1")
        run.final.mkdir()
        (run.final / "theirs").touch()


def test_nothing_is_in_its_place_before_the_end(tmp_path):
    with RunFolder("paint", tmp_path / "out") as folder:
        write(folder, a="1")
        assert not (tmp_path / "out").exists()
        assert folder.files() == ["a"]
    assert (tmp_path / "out" / "a").read_text() == "1"
    assert [entry.name for entry in tmp_path.iterdir()] == ["out"]


@pytest.mark.parametrize("error", [RuntimeError, KeyboardInterrupt, SystemExit])
@pytest.mark.parametrize("there", [False, True])
def test_a_failure_leaves_everything_as_it_was(tmp_path, error, there):
    out = tmp_path / "a" / "b"
    if there:
        out.mkdir(parents=True)
    with pytest.raises(error):
        fail(RunFolder("paint", out), error)
    assert out.exists() == there
    assert (tmp_path / "a").exists() == there
    assert not there or list(out.iterdir()) == []


def test_runs_are_numbered(tmp_path):
    for _ in range(2):
        with RunFolder("paint") as folder:
            write(folder, a="1")
    assert folder.final == tmp_path / "runs" / "paint-2"
    assert sorted(entry.name for entry in (tmp_path / "runs").iterdir()) == ["paint-1", "paint-2"]


def test_two_runs_at_once_get_two_numbers():
    with RunFolder("paint") as first:
        write(first, a="1")
        with RunFolder("paint") as second:
            write(second, a="2")
    assert (first.final.name, second.final.name) == ("paint-2", "paint-1")
    assert (second.final / "a").read_text() == "2"


def test_a_used_folder_is_never_overwritten_silently(tmp_path):
    (tmp_path / "mine").write_text("precious")
    with pytest.raises(InputError, match="not empty"), RunFolder("paint", tmp_path):
        pass
    assert [entry.name for entry in tmp_path.iterdir()] == ["mine"]


def test_overwriting_replaces_an_earlier_run_and_nothing_else(tmp_path):
    out = tmp_path / "out"
    with RunFolder("paint", out) as folder:
        write(folder, a="1", b="1", **{"summary.json": json.dumps({"files": ["a", "b", "../outside"]})})
    (out / "mine").write_text("precious")
    (tmp_path / "outside").write_text("precious")
    with RunFolder("paint", out, overwrite=True) as folder:
        write(folder, a="2", **{"summary.json": "{}"})
        assert (out / "a").read_text() == "1"
    assert sorted(entry.name for entry in out.iterdir()) == ["a", "mine", "summary.json"]
    assert (out / "a").read_text() == "2"
    assert (tmp_path / "outside").exists()


def test_a_failed_overwrite_keeps_the_earlier_run(tmp_path):
    (tmp_path / "a").write_text("1")
    with pytest.raises(RuntimeError):
        fail(RunFolder("paint", tmp_path, overwrite=True), RuntimeError)
    assert [entry.name for entry in tmp_path.iterdir()] == ["a"]
    assert (tmp_path / "a").read_text() == "1"


def test_a_folder_made_meanwhile_is_not_touched(tmp_path):
    out = tmp_path / "out"
    with pytest.raises(InputError, match="meanwhile"):
        be_late(RunFolder("paint", out))
    assert [entry.name for entry in out.iterdir()] == ["theirs"]
    assert [entry.name for entry in tmp_path.iterdir()] == ["out"]


def test_others_may_read_the_folder_as_the_user_allows(tmp_path):
    before = os.umask(0o022)
    try:
        with RunFolder("paint", tmp_path / "out") as folder:
            write(folder, a="1")
    finally:
        os.umask(before)
    assert (tmp_path / "out").stat().st_mode & 0o777 == 0o755
