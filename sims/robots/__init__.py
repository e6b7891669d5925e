"""Robots, described by MJCF or URDF: chain, limits and body, read from the compiled model."""

from sims.robots.checks import check_can_paint
from sims.robots.load import load_robot
from sims.robots.model import chain_from_model
from sims.robots.parts import body_parts
from sims.robots.read import robot_model
from sims.robots.robot import Robot

__all__ = ["Robot", "body_parts", "chain_from_model", "check_can_paint", "load_robot", "robot_model"]
