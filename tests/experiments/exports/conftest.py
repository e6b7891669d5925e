"""A short planned motion of the reference robot, by hand."""

import numpy as np
import pytest

from sims.painting.joint_plan import JointTrajectory, smooth_trajectory
from sims.robots import robot_model

NAMES = (
    "base_x", "base_y", "base_yaw", "shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3",
)  # fmt: skip
UNITS = ("m", "m", *["rad"] * 7)


@pytest.fixture(scope="session")
def waving() -> JointTrajectory:
    """Three seconds from home: all joints go forth and back, two seconds of it with the pen down."""
    model = robot_model()
    home = np.array([model.key_qpos[0][model.joint(name).qposadr[0]] for name in NAMES])
    time = np.linspace(0, 3, 61)
    reach = np.array([0.2, -0.2, 0.2, 0.3, -0.2, 0.2, 0.3, 0.3, 1e-7])
    position = home + reach * (np.sin(np.pi * time / 3) ** 4)[:, None]
    return smooth_trajectory(NAMES, UNITS, time, position, (time >= 0.5) & (time <= 2.5))
