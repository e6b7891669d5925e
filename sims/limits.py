"""What controllers are told of a simulated robot."""

import jax.numpy as jnp

from jaxpaint.kinematics import forward, no_parts
from opt.wbc import RobotLimits
from sims.robots import Robot, body_parts


def robot_limits(robot: Robot, *, clearance: bool = True) -> RobotLimits:
    """The chain, the limits, the drive and the body of a robot. clearance: false leaves the body out, and
    with it the rows that keep it clear.
    """
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
        parts=body_parts(robot) if clearance else no_parts(robot.chain),
    )
