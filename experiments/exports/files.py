"""Which files a planned trajectory can be written to."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from experiments.exports.ros2 import write_json, write_yaml
from experiments.exports.table import write_table

if TYPE_CHECKING:  # the simulation loads jax, which no command line should wait for
    from sims.painting.joint_plan import JointTrajectory

KINDS = {
    "csv": ("trajectory.csv", write_table),
    "ros2-json": ("trajectory.json", write_json),
    "ros2-yaml": ("trajectory.yaml", write_yaml),
}
"""Name of each kind of export: its file, and who writes it."""


def export(plan: "JointTrajectory", folder: Path, kinds: Sequence[str]) -> list[Path]:
    """Writes the trajectory into `folder`, one file a kind; gives their paths."""
    written = []
    for kind in dict.fromkeys(kinds):
        name, write = KINDS[kind]
        write(plan, folder / name)
        written.append(folder / name)
    return written
