"""One simulated robot: its true state, and one control step of fidelity `kinematic`."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.kinematics.steering import base_twist
from opt.controller import Command, Measured
from opt.wbc import RobotLimits
from sims.driver import Wheels, drive
from sims.odometry import OdometryNoise, Slip, moved, reported_speed, true_motion

# Acceleration of the rims [m/s^2]: the drives' own limit, above what any controller asks for.
_RIM_ACCELERATION = 2.0


class World(eqx.Module):
    """The truth. base: pose (x, y, yaw) in the map. arm, arm_velocity: joints. wheels: angles and rim speeds.
    odometry: the base pose that odometry believes. slip: this world's own errors.
    """

    base: Float[Array, "3"]
    arm: Float[Array, "a"]
    arm_velocity: Float[Array, "a"]
    wheels: Wheels
    odometry: Float[Array, "3"]
    slip: Slip

    def measured(self) -> Measured:
        """All that a controller may see of it."""
        return Measured(self.odometry, self.arm, self.wheels.angle)


def standing(base: Float[Array, "3"], arm: Float[Array, "a"], slip: Slip, wheels: int) -> World:
    """A robot at rest whose odometry is right."""
    still = jnp.zeros((wheels,), base.dtype)
    return World(base, arm, jnp.zeros_like(arm), Wheels(still, still), base, slip)


def step(
    robot: RobotLimits,
    noise: OdometryNoise,
    world: World,
    command: Command,
    shock: Float[Array, "3"],
    dt: Float[Array, ""],
) -> World:
    """One control step: commanded velocities within the drives' limits, integrated on SE(2) and the joints.

    shock: standard normal numbers for the odometry's random walk.
    """
    wheels = drive(
        robot.steering, world.wheels, command.base_twist, command.steer_twist, _RIM_ACCELERATION, dt
    )
    rolled = base_twist(robot.steering, wheels.angle, wheels.speed)
    reported = base_twist(robot.steering, wheels.angle, reported_speed(noise, wheels.speed))
    turned = jnp.abs(wheels.angle - world.wheels.angle).mean()
    change = robot.arm_acceleration * dt
    velocity = world.arm_velocity + jnp.clip(command.arm_velocity - world.arm_velocity, -change, change)
    velocity = jnp.clip(velocity, -robot.arm_speed, robot.arm_speed)
    return World(
        base=moved(world.base, true_motion(noise, world.slip, rolled, turned, shock, dt)),
        arm=jnp.clip(world.arm + velocity * dt, robot.arm_lower, robot.arm_upper),
        arm_velocity=velocity,
        wheels=wheels,
        odometry=moved(world.odometry, reported * dt),
        slip=world.slip,
    )
