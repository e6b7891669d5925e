"""Painting, paint included, beside one world of MuJoCo with a QP in a Python loop."""

import numpy as np

from experiments.benchmarks.compare import compare
from experiments.benchmarks.rows import BenchRow
from experiments.benchmarks.serial_loop_peer import control_steps_per_second
from experiments.commands.paint_options import PaintOptions
from experiments.paint import steps_of
from experiments.paint_job import paint_task
from sims.painting import run_mission

_WORLDS = 256


def rows() -> list[BenchRow]:
    """Control steps a second of `paint` (kinematic, the default drawing), as `steps_per_s` of its summary."""
    task = paint_task(PaintOptions(worlds=_WORLDS))

    def ours() -> float:
        mission = run_mission(task.job, task.grid, np.arange(_WORLDS))
        return float(steps_of(mission).sum()) / mission.executed_s

    return [compare("painting-step", ours, control_steps_per_second, "MuJoCo and DAQP in a loop", rounds=3)]
