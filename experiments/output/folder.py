"""The folder of a run: filled beside its place and put there at the end, whole or not at all."""

import json
import os
import shutil
import tempfile
from pathlib import Path
from typing import Self

from experiments.interrupts import shielded
from jaxpaint.errors import InputError

SUMMARY = "summary.json"
RUNS = Path("runs")


class RunFolder:
    """Where a command writes; used as a context.

    with RunFolder("paint", out, overwrite) as folder:
        (folder.path("summary.json")).write_text(...)
    print(folder.final)

    Leaving the context puts everything in its place; leaving it by an exception leaves nothing. A new folder
    appears by one rename. Into a folder that exists (empty, or `overwrite`) each file is renamed on its own,
    summary.json last, and the files that an earlier run listed in its summary go away; others are left alone.
    out None: the first free runs/<command>-<number>.
    """

    def __init__(self, command: str, out: Path | None = None, overwrite: bool = False) -> None:
        self._command = command
        self._numbered = out is None
        self.final = _first_free(command) if out is None else out.absolute()
        self._overwrite = overwrite
        self._into = False
        self._stage: Path | None = None
        self._made: list[Path] = []

    def path(self, name: str) -> Path:
        """Where to write the file `name` now."""
        if self._stage is None:
            raise RuntimeError("RunFolder.path: the folder is not open")
        return self._stage / name

    def files(self) -> list[str]:
        """Names written so far."""
        stage = self.path("")
        return sorted(str(entry.relative_to(stage)) for entry in stage.rglob("*") if entry.is_file())

    def __enter__(self) -> Self:
        _check(self.final, self._overwrite)
        self._into = self.final.is_dir()
        parent = self.final if self._into else self.final.parent
        try:
            self._made = _make(parent)
            self._stage = Path(tempfile.mkdtemp(prefix=_prefix(self.final.name, os.getpid()), dir=parent))
            self._stage.chmod(0o777 & ~_umask())  # mkdtemp makes it private
        except OSError as error:
            self._discard()
            raise InputError(
                f"--out: found {self.final} ({error.strerror}), allowed: a folder to write in"
            ) from error
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        with shielded():
            try:
                if kind is None:
                    self._put()
            finally:
                self._discard()

    def _put(self) -> None:
        stage = self.path("")
        if self._into:
            _move_each(stage, self.final, self.files())
            return
        while True:
            try:
                stage.rename(self.final)
                return
            except OSError:
                # Another run took this place meanwhile.
                if not self.final.exists():
                    raise
                if not self._numbered:
                    raise InputError(
                        f"--out: found {self.final} (made meanwhile), allowed: a new folder"
                    ) from None
                self.final = _first_free(self._command)

    def _discard(self) -> None:
        if self._stage is not None and self._stage.exists():
            shutil.rmtree(self._stage, ignore_errors=True)
        self._stage = None
        for parent in reversed(self._made):
            if parent.is_dir() and not any(parent.iterdir()):
                parent.rmdir()


def sweep(out: Path | None, pid: int) -> None:
    """Removes what the process `pid`, which was killed, left half-written of its run into `out`."""
    parents = (RUNS,) if out is None else (out, out.parent)
    for stage in (found for parent in parents for found in parent.glob(_prefix("*", pid) + "*")):
        shutil.rmtree(stage, ignore_errors=True)


def _prefix(name: str, pid: int) -> str:
    return f".{name}.partial-{pid}-"


def _check(folder: Path, overwrite: bool) -> None:
    """InputError where a run may not write."""
    try:
        if folder.exists() and not folder.is_dir():
            raise InputError(f"--out: found {folder} (a file), allowed: a new or empty folder")
        if folder.is_dir() and any(folder.iterdir()) and not overwrite:
            raise InputError(
                f"--out: found {folder} (not empty), allowed: a new or empty folder, or --overwrite"
            )
    except OSError as error:
        raise InputError(
            f"--out: found {folder} ({error.strerror}), allowed: a new or empty folder"
        ) from error


def _first_free(command: str) -> Path:
    number = 1
    while (RUNS / f"{command}-{number}").exists():
        number += 1
    return (RUNS / f"{command}-{number}").absolute()


def _make(folder: Path) -> list[Path]:
    """Make a folder with its parents; those that were not there, outermost first."""
    missing = [entry for entry in (folder, *folder.parents) if not entry.exists()]
    folder.mkdir(parents=True, exist_ok=True)
    return missing[::-1]


def _move_each(stage: Path, target: Path, names: list[str]) -> None:
    """Rename every staged file into `target`, the summary last: where it is, the run is whole."""
    stale = _earlier_files(target)
    for name in sorted(names, key=lambda name: name == SUMMARY):
        (target / name).parent.mkdir(parents=True, exist_ok=True)
        os.replace(stage / name, target / name)
    for name in stale - set(names):
        (target / name).unlink(missing_ok=True)


def _earlier_files(target: Path) -> set[str]:
    """Files that an earlier run wrote, by its own summary; never anything outside `target`."""
    try:
        listed = json.loads((target / SUMMARY).read_text())["files"]
    except (OSError, ValueError, KeyError, TypeError):
        return set()
    names = {name for name in listed if isinstance(name, str)} if isinstance(listed, list) else set()
    return {name for name in names if (target / name).resolve().is_relative_to(target.resolve())}


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
