"""A small painting mission with robots that are not the reference."""

from pathlib import Path

import numpy as np
import pytest

from experiments.commands.paint_options import PaintOptions
from experiments.paint import score
from experiments.paint_job import paint_task
from sims.painting import run_mission

ROBOTS = Path(__file__).resolve().parents[2] / "robots"
WORLDS = 8


# Slow, since each robot is a mission to compile; tests/opt/wbc/test_arms.py follows a circle with
# two of them, and tests/sims/robots/test_own_robots.py reads all and has them reach a wall.
@pytest.mark.slow
@pytest.mark.parametrize("name", ["seven_joints.xml", "mecanum.xml", "big_arm.xml", "big_arm.urdf"])
def test_any_arm_on_any_base_paints(two_strokes, name):
    task = paint_task(
        PaintOptions(image=two_strokes, canvas_size=(0.5, 0.5), worlds=WORLDS, robot=ROBOTS / name)
    )
    rows = score(task, run_mission(task.job, task.grid, np.arange(WORLDS)))
    assert [row.status for row in rows] == ["ok"] * WORLDS
    assert np.median([row.rmse_total for row in rows]) < 0.003
    assert min(row.coverage for row in rows) > 0.95
    assert max(row.stroke_error_mean for row in rows) < 0.004
