"""The robot by servos paints as well as by commanded velocities. Minutes each."""

import pytest

from experiments.commands.paint_options import PaintOptions
from experiments.paint import run
from experiments.progress import progress

WORLDS = 64


def painted(wall: str, fidelity: str):
    return run(PaintOptions(wall=wall, fidelity=fidelity, worlds=WORLDS), progress).summary


@pytest.mark.slow
@pytest.mark.parametrize("wall", ["flat", "corner", "cylinder"])
def test_the_default_drawing_by_servos(wall):
    """The bars are those of the kinematic runs; the paint itself lies where it lies in those."""
    found, kinematic = painted(wall, "dynamic"), painted(wall, "kinematic")
    assert found["status"]["ok"] >= WORLDS - 1
    assert found["tracking_rmse"]["total"] <= 0.010
    assert found["normal_error_deg"]["mean"] <= 3.0
    ratio = found["paint"]["stroke_error"]["mean"] / kinematic["paint"]["stroke_error"]["mean"]
    assert ratio == pytest.approx(1.0, abs=0.2)
