"""The robots of tests/robots."""

from pathlib import Path

import pytest

from sims.robots import load_robot

FOLDER = Path(__file__).resolve().parents[2] / "robots"
NAMES = ("seven_joints.xml", "mecanum.xml", "big_arm.urdf", "big_arm.xml")


@pytest.fixture(scope="session", params=NAMES)
def own(request):
    """The file of a robot that is not the reference, and the robot."""
    path = FOLDER / request.param
    return path, load_robot(path)


@pytest.fixture(scope="session")
def urdf_text():
    """A URDF as they come."""
    return (FOLDER / "big_arm.urdf").read_text()
