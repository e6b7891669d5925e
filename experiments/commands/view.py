"""`jaxpaint view`: a finished painting run to look at, as a film strip and as a model that plays."""

import dataclasses
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, ClassVar

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
        from experiments.viewing import draw_film, find_opengl, read_recorded, write_view
        from experiments.viewing.opengl import MISSING

        recorded = read_recorded(options.run, "RUN")
        world = recorded.worlds[0] if options.world is None else options.world
        motion = recorded.motion(world)
        write_view(recorded, motion, folder.path(""), options.size[0] / options.size[1])
    frames = options.frames or FRAMES
    environment = find_opengl()
    if environment is not None:
        draw_film(folder.path(""), folder.path(FILM), frames, options.size, environment)
    notes = () if environment is not None else (MISSING,)
    drawn = frames if environment is not None else 0
    asked = options.frames is not None and "frames" not in options.chosen
    return Outcome(
        summary={"run": recorded.folder, "world": world, "frames": drawn, "files": [], "notes": list(notes)},
        tables=(_table(folder, world, float(motion.time[-1]), drawn, notes),),
        resolved={
            name: value
            for name, value in (("world", world), ("frames", frames))
            if getattr(options, name) is None
        },
        failure=MISSING if notes and asked else None,
    )


def _table(folder: RunFolder, world: int, seconds: float, frames: int, notes: tuple[str, ...]) -> Table:
    rows = (
        ("world", str(world)),
        ("simulated time", f"{seconds:.1f} s"),
        *([("film strip", f"{frames} pictures in {folder.final / FILM}")] if frames else []),
        ("in MuJoCo's viewer", f"python {folder.final / 'play.py'}"),
        ("its moments", f"python -m mujoco.viewer --mjcf={folder.final / 'model.xml'}"),
        *(("note", note) for note in notes),
    )
    return Table(("what", "value"), rows, f"View of {world}")


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
