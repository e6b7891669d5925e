"""`jaxpaint view`: a finished painting run to look at, as a film strip and as a model that plays."""

import dataclasses
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any, ClassVar

from tyro.conf import Positional

from experiments import values as allowed
from experiments.commands.command import Command, Outcome, RunOptions
from experiments.options import refuse
from experiments.output import RunFolder
from experiments.tables import Table

FILM = "film.png"
FRAMES = 6
LARGEST = 2 * 10**8


@dataclasses.dataclass(frozen=True, kw_only=True)
class ViewOptions(RunOptions):
    """Look at a painting run: a film strip of the robot at the wall, and a MuJoCo model that plays it."""

    run: Annotated[Positional[Path], allowed.earlier_run("RUN")]
    """The run of 'jaxpaint paint': its folder, or its summary.json."""
    world: Annotated[int | None, allowed.whole("W", at_least=0, unset="the first that is recorded")] = None
    """World that is shown, one of those recorded ('paint --record')."""
    frames: Annotated[int | None, allowed.whole("N", at_least=1, at_most=1000, unset=str(FRAMES))] = None
    """Pictures of the film strip, evenly spaced over the run. Given, it asks for OpenGL: without, the exit
    status is 1."""
    size: Annotated[tuple[int, int], allowed.whole("WIDTH HEIGHT", at_least=64, at_most=4096, count=2)] = (
        720,
        540,
    )
    """Width and height of one picture [pixels]."""

    CHOSEN_FROM: ClassVar[Mapping[str, tuple[str, ...]]] = {"world": ("run",), "frames": ()}

    def check(self) -> None:
        """Raise InputError for the first option that is not allowed, alone or beside another."""
        super().check()
        if (self.frames or FRAMES) * self.size[0] * self.size[1] > LARGEST:
            refuse(
                "--frames, --size", (self.frames or FRAMES, *self.size), f"{LARGEST} pixels in all or fewer"
            )


def execute(options: ViewOptions, folder: RunFolder) -> Outcome:
    """Writes model.xml, trajectory.npz, play.py, and film.png where there is OpenGL."""
    with _no_opengl_of_ours():
        from experiments.viewing import read_recorded, write_view

        recorded = read_recorded(options.run, "RUN")
        world = recorded.worlds[0] if options.world is None else options.world
        motion = recorded.motion(world)
        write_view(recorded, motion, folder.path(""), options.size[0] / options.size[1])
    frames = options.frames or FRAMES
    notes, failed = _film(options, folder.path(""), frames)
    found = {"run": recorded.folder, "world": world, "frames": 0 if notes else frames}
    chosen = {"world": world, "frames": frames}
    return Outcome(
        summary={**found, "files": [], "notes": notes},  # the files are named when all are written
        tables=(_table(folder, found, float(motion.time[-1]), notes),),
        resolved={name: value for name, value in chosen.items() if getattr(options, name) is None},
        failure=notes[0] if failed else None,
    )


def _film(options: ViewOptions, folder: Path, frames: int) -> tuple[list[str], bool]:
    """Draws film.png. Why there is none, in words, and whether that is a failure."""
    from experiments.viewing import draw_film, find_opengl
    from experiments.viewing.opengl import MISSING

    environment = find_opengl()
    if environment is None:
        return [MISSING], options.frames is not None and "frames" not in options.chosen
    try:
        draw_film(folder, folder / FILM, frames, options.size, environment)
    except RuntimeError as error:
        (folder / FILM).unlink(missing_ok=True)
        return [str(error)], True
    return [], False


def _table(folder: RunFolder, found: Mapping[str, Any], seconds: float, notes: list[str]) -> Table:
    """What was written and how it is shown."""
    rows = (
        ("world", str(found["world"])),
        ("simulated time", f"{seconds:.1f} s"),
        *(
            [("film strip", f"{found['frames']} pictures in {folder.final / FILM}")]
            if found["frames"]
            else []
        ),
        ("in MuJoCo's viewer", f"python {folder.final / 'play.py'}"),
        ("its moments", f"python -m mujoco.viewer --mjcf={folder.final / 'model.xml'}"),
        *(("note", note) for note in notes),
    )
    return Table(("what", "value"), rows, f"View of {found['run']}")


@contextmanager
def _no_opengl_of_ours() -> Iterator[None]:
    """Takes MUJOCO_GL away while mujoco is imported: where its OpenGL is missing the import would fail, and
    this process draws nothing.
    """
    chosen = os.environ.pop("MUJOCO_GL", None)
    try:
        yield
    finally:
        if chosen is not None:
            os.environ["MUJOCO_GL"] = chosen


COMMAND = Command("view", ViewOptions, execute)
