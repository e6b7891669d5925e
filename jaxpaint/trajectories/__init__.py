"""Motion of joints in time, within limits, and whether it stays clear of the wall."""

from jaxpaint.trajectories.clearance import clearance
from jaxpaint.trajectories.quintic import Quintic, State, evaluate, fastest_quintic, quintic, rest_duration
from jaxpaint.trajectories.waypoints import Trajectory, plan, plan_base_and_arm, sample

__all__ = [
    "Quintic",
    "State",
    "Trajectory",
    "clearance",
    "evaluate",
    "fastest_quintic",
    "plan",
    "plan_base_and_arm",
    "quintic",
    "rest_duration",
    "sample",
]
