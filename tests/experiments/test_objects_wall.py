"""Painting about things that stand and hang before a wall. Minutes."""

import pytest

from experiments.commands.paint_options import PaintOptions
from experiments.paint import run
from experiments.progress import progress

WORLDS = 16


@pytest.mark.slow
def test_the_default_drawing_among_objects():
    """All of it is within reach, though the lidar meets the crate and cannot tell where it ends.

    One world may find no clear way to its views between the things.
    """
    found = run(PaintOptions(wall="objects", worlds=WORLDS), progress).summary
    assert found["status"]["ok"] >= WORLDS - 1
    assert found["paint"]["coverage"] >= 0.9
    assert found["paint"]["excess"] <= 0.05
