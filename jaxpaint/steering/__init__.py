"""How a base rolls: its twist to wheels and back, for steered, caster, mecanum and differential bases."""

from jaxpaint.steering.angles import wrap
from jaxpaint.steering.casters import CasterWheels
from jaxpaint.steering.differential import DifferentialWheels, differential
from jaxpaint.steering.drive import AbstractDrive, Odometry, Stance, Step, WheelMotion
from jaxpaint.steering.limits import Driven, Limited, driven, limited
from jaxpaint.steering.odometry import rigid_twist
from jaxpaint.steering.rollers import RollerWheels, mecanum
from jaxpaint.steering.steered import SteeredWheels, WheelCommands, holonomic, wheel_commands

__all__ = [
    "AbstractDrive",
    "CasterWheels",
    "DifferentialWheels",
    "Driven",
    "Limited",
    "Odometry",
    "RollerWheels",
    "Stance",
    "SteeredWheels",
    "Step",
    "WheelCommands",
    "WheelMotion",
    "differential",
    "driven",
    "holonomic",
    "limited",
    "mecanum",
    "rigid_twist",
    "wheel_commands",
    "wrap",
]
