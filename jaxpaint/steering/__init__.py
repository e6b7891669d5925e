"""How a base rolls: its twist to wheels and back, for steered, mecanum and differential bases."""

from jaxpaint.steering.angles import wrap
from jaxpaint.steering.drive import AbstractDrive
from jaxpaint.steering.rollers import RollerWheels, mecanum
from jaxpaint.steering.steered import SteeredWheels, holonomic

__all__ = ["AbstractDrive", "RollerWheels", "SteeredWheels", "holonomic", "mecanum", "wrap"]
