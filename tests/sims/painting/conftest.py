"""One small mission, run once for all tests that look at what a run did."""

import numpy as np
import pytest

from experiments.commands.paint_options import PaintOptions
from experiments.paint_job import paint_task
from sims.painting import run_mission

PICTURE = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 60 60" fill="none" stroke="black">
<path d="M5 10 H40"/><path d="M5 30 Q25 50 50 30"/></svg>"""
WORLDS = 4


@pytest.fixture(scope="session")
def two_strokes(tmp_path_factory):
    """A picture's file: a line and an arc."""
    picture = tmp_path_factory.mktemp("picture") / "two.svg"
    picture.write_text(PICTURE)
    return picture


@pytest.fixture(scope="session")
def task(two_strokes):
    """Half a metre of the flat wall, in four worlds."""
    return paint_task(PaintOptions(image=two_strokes, canvas_size=(0.5, 0.5), worlds=WORLDS))


@pytest.fixture(scope="session")
def mission(task):
    """All worlds of the task, painted."""
    return run_mission(task.job, task.grid, np.arange(WORLDS))
