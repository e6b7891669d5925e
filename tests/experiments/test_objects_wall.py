"""Painting about things that stand and hang before a wall. Minutes."""

import pytest

from experiments.commands.paint_options import PaintOptions
from experiments.paint import run
from experiments.progress import progress

WORLDS = 16


@pytest.mark.slow
def test_the_default_drawing_among_objects():
    """All of it is within reach, though the lidar meets the crate and cannot tell where it ends."""
    found = run(PaintOptions(wall="objects", worlds=WORLDS), progress).summary
    assert set(found["status"]) <= {"ok", "not_converged"}
    assert found["status"]["ok"] >= 0.7 * WORLDS
    assert found["paint"]["coverage"] >= 0.9
    assert found["paint"]["excess"] <= 0.05
