"""A joint trajectory as a table of comma-separated values."""

import csv
import re
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from jaxpaint.errors import InputError

if TYPE_CHECKING:
    from sims.painting.joint_plan import JointTrajectory

PEN = "pen [0 or 1]"
_QUANTITIES = {"position": "", "velocity": "/s", "acceleration": "/s^2"}
_POSITION = re.compile(r"(.+) position \[(m|rad)\]")


def columns(names: tuple[str, ...], units: tuple[str, ...]) -> list[str]:
    """The header: time, then all positions, all velocities, all accelerations, with units, and the pen."""
    joints = list(zip(names, units, strict=True))
    figures = [f"{name} {what} [{unit}{per}]" for what, per in _QUANTITIES.items() for name, unit in joints]
    return ["time [s]", *figures, PEN]


def write_table(plan: "JointTrajectory", path: Path) -> None:
    """One row a sample; every number with all its digits, so that reading gives the same bits."""
    figures = np.column_stack([plan.time, plan.position, plan.velocity, plan.acceleration])
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns(plan.names, plan.units))
        pens = plan.pen.astype(int).tolist()
        writer.writerows([*row, pen] for row, pen in zip(figures.tolist(), pens, strict=True))


def read_table(path: Path) -> "JointTrajectory":
    """The trajectory that `write_table` wrote; InputError for anything else."""
    from sims.painting.joint_plan import JointTrajectory

    allowed = "a trajectory.csv of 'jaxpaint paint --export csv'"
    try:
        with path.open(newline="", encoding="utf-8") as file:
            header, *rows = csv.reader(file)
        figures = np.array(rows, float)
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: found {_cause(error)}, allowed: {allowed}") from error
    found = [match.groups() for column in header if (match := _POSITION.fullmatch(column))]
    names, units = tuple(name for name, _ in found), tuple(unit for _, unit in found)
    if header != columns(names, units) or len(rows) < 2 or not np.isfinite(figures).all():
        raise InputError(f"{path}: found other columns or too few rows, allowed: {allowed}")
    if not (np.diff(figures[:, 0]) > 0).all():
        raise InputError(f"{path}: found times that do not increase, allowed: {allowed}")
    position, velocity, acceleration = np.split(figures[:, 1:-1], 3, axis=1)
    return JointTrajectory(
        names, units, figures[:, 0], position, velocity, acceleration, figures[:, -1] > 0.5
    )


def _cause(error: Exception) -> str:
    return (isinstance(error, OSError) and error.strerror) or "no table of numbers"
