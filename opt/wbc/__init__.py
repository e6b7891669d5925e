"""The whole-body controller: the tree shows the theory, tasks and limits that add up to one QP."""

from opt.wbc.controller import ControlStatus, WholeBodyController
from opt.wbc.reference import Reference
from opt.wbc.robot import RobotLimits
from opt.wbc.settings import ControllerSettings, default_settings

__all__ = [
    "ControlStatus",
    "ControllerSettings",
    "Reference",
    "RobotLimits",
    "WholeBodyController",
    "default_settings",
]
