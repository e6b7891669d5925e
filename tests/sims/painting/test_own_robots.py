"""A small painting mission with robots that are not the reference."""

from pathlib import Path

import numpy as np
import pytest

from experiments.commands.paint_options import PaintOptions
from experiments.paint import score
from experiments.paint_job import paint_task
from sims.painting import run_mission

ROBOTS = Path(__file__).resolve().parents[2] / "robots"
PICTURE = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 60 60" fill="none" stroke="black">
<path d="M5 10 H40"/><path d="M5 30 Q25 50 50 30"/></svg>"""
WORLDS = 8


@pytest.mark.parametrize(
    "name",
    [
        "seven_joints.xml",
        pytest.param("mecanum.xml", marks=pytest.mark.slow),
        pytest.param("big_arm.xml", marks=pytest.mark.slow),
        pytest.param("big_arm.urdf", marks=pytest.mark.slow),
    ],
)
def test_any_arm_on_any_base_paints(tmp_path, name):
    picture = tmp_path / "two.svg"
    picture.write_text(PICTURE)
    task = paint_task(PaintOptions(image=picture, canvas_size=(0.5, 0.5), worlds=WORLDS, robot=ROBOTS / name))
    rows = score(task, run_mission(task.job, task.grid, np.arange(WORLDS)))
    assert [row.status for row in rows] == ["ok"] * WORLDS
    assert np.median([row.rmse_total for row in rows]) < 0.003
    assert min(row.coverage for row in rows) > 0.95
    assert max(row.stroke_error_mean for row in rows) < 0.004
