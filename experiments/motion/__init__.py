"""Random missions of the trajectory controller's planner, checked by means that owe nothing to it."""

from experiments.motion.checks import Checked, check
from experiments.motion.missions import Missions, random_missions
from experiments.motion.topp import fastest_time

__all__ = ["Checked", "Missions", "check", "fastest_time", "random_missions"]
