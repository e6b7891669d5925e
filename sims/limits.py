"""What controllers are told of a simulated robot."""

import jax.numpy as jnp

from jaxpaint.kinematics.chain import forward
from opt.wbc import RobotLimits
from sims.robots import Robot


def robot_limits(robot: Robot) -> RobotLimits:
    """The chain, the limits and the drive of a robot."""
    base = robot.base_size
    brush = forward(robot.chain, robot.at_home(jnp.zeros(3))).p
    return RobotLimits(
        chain=robot.chain,
        drive=robot.drive,
        home=brush[:2],
        base_speed=robot.speed_limit[:base],
        base_acceleration=robot.acceleration_limit[:base],
        arm_lower=robot.lower,
        arm_upper=robot.upper,
        arm_speed=robot.speed_limit[base:],
        arm_acceleration=robot.acceleration_limit[base:],
    )
