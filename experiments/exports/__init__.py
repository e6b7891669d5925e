"""Planned joint trajectories for the world outside: a table, and the message that ROS 2 controllers take."""

from experiments.exports.files import KINDS, export
from experiments.exports.ros2 import to_message
from experiments.exports.table import read_table, write_table

__all__ = ["KINDS", "export", "read_table", "to_message", "write_table"]
