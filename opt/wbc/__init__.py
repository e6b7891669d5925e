"""The whole-body controller: the tree shows the theory, tasks and limits that add up to one QP."""

from opt.wbc.controller import RobotLimits, WholeBodyController
from opt.wbc.settings import ControllerSettings, default_settings
from opt.wbc.task import Reference

__all__ = ["ControllerSettings", "Reference", "RobotLimits", "WholeBodyController", "default_settings"]
