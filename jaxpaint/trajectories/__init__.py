"""Motion of joints in time, within limits, and whether it stays clear of the wall."""

from jaxpaint.trajectories.clearance import Obstacles, gap_on_the_way
from jaxpaint.trajectories.detours import WAYS, detours
from jaxpaint.trajectories.footprint import footprint_gap, signed_distance
from jaxpaint.trajectories.own_clearance import own_gap, own_gap_at
from jaxpaint.trajectories.s_curve import Progress, SCurve, progress, s_curve, stretched
from jaxpaint.trajectories.torque import plan_within_torque, slow_down
from jaxpaint.trajectories.waypoints import (
    Limits,
    State,
    Trajectory,
    on_one_clock,
    on_segment,
    plan_base_and_arm,
    sample,
    slowed,
)

__all__ = [
    "WAYS",
    "Limits",
    "Obstacles",
    "Progress",
    "SCurve",
    "State",
    "Trajectory",
    "detours",
    "footprint_gap",
    "gap_on_the_way",
    "on_one_clock",
    "on_segment",
    "own_gap",
    "own_gap_at",
    "plan_base_and_arm",
    "plan_within_torque",
    "progress",
    "s_curve",
    "sample",
    "signed_distance",
    "slow_down",
    "slowed",
    "stretched",
]
