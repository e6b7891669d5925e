"""What a finished painting run left that can be looked at: its options, and the motion of a world."""

import dataclasses
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import NoReturn

import numpy as np
from jaxtyping import Float, Int

from experiments.commands.paint_options import PaintOptions
from experiments.comparison import SUMMARY, read_run
from experiments.options import check, from_config
from jaxpaint.errors import InputError

TRAJECTORIES = "trajectories.npz"
_AXES = {
    "world": 1,
    "time": 2,
    "stroke": 2,
    "colour": 2,
    "brush": 3,
    "base": 3,
    "tilt": 3,
    "joints": 3,
    "joint_names": 1,
    "palette": 2,
}
"""Arrays that are needed, with their numbers of axes."""


@dataclasses.dataclass(frozen=True, eq=False)
class Motion:
    """What one world's robot did while it painted. time [s]; joints: positions of the joints `names`, base
    first [m, rad]; tilt: height [m], roll and pitch [rad] of the base over a level floor; brush: its tip in
    the map frame [m]; stroke: number of the drawn stroke, -1 with the pen up; colour: row of palette, sRGB
    from 0 to 1.
    """

    world: int
    names: tuple[str, ...]
    time: Float[np.ndarray, " t"]
    joints: Float[np.ndarray, "t joints"]
    tilt: Float[np.ndarray, "t 3"]
    brush: Float[np.ndarray, "t 3"]
    stroke: Int[np.ndarray, " t"]
    colour: Int[np.ndarray, " t"]
    palette: Float[np.ndarray, "colours 3"]


@dataclasses.dataclass(frozen=True, eq=False)
class Recorded:
    """A run's folder, the options of its robot and wall, and its recorded arrays."""

    folder: Path
    options: PaintOptions
    arrays: Mapping[str, np.ndarray]

    @property
    def worlds(self) -> list[int]:
        """The recorded worlds."""
        return self.arrays["world"].tolist()

    def motion(self, world: int) -> Motion:
        """The motion of a world. Raises InputError where it is not recorded, or did not move."""
        listed = " ".join(map(str, self.worlds))
        if world not in self.worlds:
            raise InputError(
                f"--world: found {world} (not recorded), allowed: {listed}, or others by 'paint --record'"
            )
        arrays, row = self.arrays, self.worlds.index(world)
        live = np.isfinite(arrays["time"][row])
        if not live.any():
            raise InputError(f"--world: found {world} (which did not paint), allowed: another of {listed}")
        return Motion(
            world=world,
            names=tuple(str(name) for name in arrays["joint_names"]),
            joints=np.concatenate([arrays["base"][row], arrays["joints"][row]], axis=1)[live],
            **{name: arrays[name][row][live] for name in ("time", "tilt", "brush", "stroke", "colour")},
            palette=arrays["palette"],
        )


def read_recorded(path: Path, option: str) -> Recorded:
    """The painting run in a folder, or of a summary.json; InputError, which names `option`, for others."""
    run = read_run(path, option)
    if run.summary["command"] != "paint":
        raise InputError(
            f"{option}: found a run of {run.summary['command']!r}, allowed: a run of 'jaxpaint paint'"
        )
    source = str(run.folder / SUMMARY)
    options = from_config(PaintOptions, run.summary["config"], source, chosen=run.summary.get("chosen", ()))
    options = dataclasses.replace(options, image=None)  # nobody reads it again
    try:
        check(options)
    except InputError as error:
        raise InputError(f"{source}: config: {error}") from error
    return Recorded(run.folder, options, _arrays(run.folder / TRAJECTORIES, option))


def _arrays(path: Path, option: str) -> dict[str, np.ndarray]:
    def refuse(cause: str) -> NoReturn:
        allowed = "that of a run of this version of 'jaxpaint paint'"
        raise InputError(f"{option}: found {path} ({cause}), allowed: {allowed}")

    try:
        with np.load(path, allow_pickle=False) as held:
            arrays = {name: held[name] for name in held.files if name in _AXES}
    except (OSError, ValueError, EOFError, zipfile.BadZipFile, AttributeError, TypeError) as error:
        refuse((isinstance(error, OSError) and error.strerror) or "not a file of arrays")
    for name, axes in _AXES.items():
        if name not in arrays:
            refuse(f"without {name}")
        if arrays[name].ndim != axes:
            refuse(f"{name} with {arrays[name].ndim} axes")
    _check_sizes(arrays, refuse)
    _check_values(arrays, refuse)
    return arrays


def _check_sizes(arrays, refuse) -> None:
    """Worlds, samples, joints and colours are as many everywhere."""
    rows = arrays["time"].shape
    wrong = [
        name
        for name, axes in _AXES.items()
        if axes > 1 and name != "palette" and arrays[name].shape[:2] != rows
    ]
    joints = arrays["base"].shape[-1] + arrays["joints"].shape[-1]
    if not rows[0] or len(arrays["world"]) != rows[0] or len(arrays["joint_names"]) != joints:
        wrong.append("world or joint_names")
    if arrays["brush"].shape[-1] != 3 or arrays["tilt"].shape[-1] != 3 or arrays["palette"].shape[-1] != 3:
        wrong.append("brush, tilt or palette")
    if (
        not wrong
        and arrays["colour"].dtype.kind in "iu"
        and not np.isin(arrays["colour"], np.arange(len(arrays["palette"]))).all()
    ):
        wrong.append("colour")
    if wrong:
        refuse(f"{wrong[0]} of another size")


def _check_values(arrays, refuse) -> None:
    """Numbers are numbers, and finite wherever a world still painted."""
    kinds = {"joint_names": "U", **dict.fromkeys(("world", "stroke", "colour"), "iu")}
    for name, array in arrays.items():
        if array.dtype.kind not in kinds.get(name, "fiu"):
            refuse(f"{name} of another kind")
    live = np.isfinite(arrays["time"])
    for name in ("base", "tilt", "joints", "brush"):
        if not np.isfinite(arrays[name][live]).all():
            refuse(f"{name} that is not finite")
    if not np.isfinite(arrays["palette"]).all():
        refuse("palette that is not finite")
    if (np.diff(arrays["time"], axis=1) <= 0).any():
        refuse("time that does not rise")
    if len(np.unique(arrays["world"])) < len(arrays["world"]):
        refuse("world more than once")
    if (arrays["stroke"] >= live.shape[1]).any():
        refuse("stroke beyond the last sample")
