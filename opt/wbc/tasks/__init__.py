"""What the whole body should do: each task adds to the cost, or asks for rows that may slack."""

from opt.wbc.tasks.base_follow import base_follow
from opt.wbc.tasks.brush import brush_twist
from opt.wbc.tasks.effort import effort
from opt.wbc.tasks.manipulability import climb

__all__ = ["base_follow", "brush_twist", "climb", "effort"]
