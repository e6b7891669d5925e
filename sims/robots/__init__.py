"""Robots, described by MJCF: the kinematic chain, the limits and the body, read from the compiled model."""

from sims.robots.load import load_robot, robot_model
from sims.robots.model import chain_from_model
from sims.robots.robot import Robot, Wheels

__all__ = ["Robot", "Wheels", "chain_from_model", "load_robot", "robot_model"]
