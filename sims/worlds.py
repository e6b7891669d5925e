"""One simulated robot: its true state, and what advances it by one control step."""

import abc

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float, PyTree

from opt.controller import Command, Measured
from opt.wbc import RobotLimits
from sims.driver import Wheels, drive
from sims.odometry import OdometryNoise, Slip, moved, reported_speed, true_motion

# Acceleration of the rims [m/s^2]: the drives' own limit, above what any controller asks for.
RIM_ACCELERATION = 2.0


class World(eqx.Module):
    """The truth. base: pose (x, y, yaw) in the map. arm, arm_velocity: joints. wheels: angles, and rim speeds
    as the drives are told. odometry: the base pose that odometry believes. slip: this world's own errors.
    servos: what only its fidelity knows.
    """

    base: Float[Array, "3"]
    arm: Float[Array, "a"]
    arm_velocity: Float[Array, "a"]
    wheels: Wheels
    odometry: Float[Array, "3"]
    slip: Slip
    servos: PyTree = ()

    def measured(self) -> Measured:
        """All that a controller may see of it."""
        return Measured(self.odometry, self.arm, self.wheels.angle)


def standing(base: Float[Array, "3"], arm: Float[Array, "a"], slip: Slip, wheels: int) -> World:
    """A robot at rest whose odometry is right."""
    still = jnp.zeros((wheels,), base.dtype)
    return World(base, arm, jnp.zeros_like(arm), Wheels(still, still), base, slip)


class Fidelity(eqx.Module):
    """How truly a world moves. It is chosen before a program is compiled; what it holds is traced."""

    @abc.abstractmethod
    def begin(self, world: World) -> World:
        """The world with all that `step` needs; at rest where it had not."""

    @abc.abstractmethod
    def step(
        self,
        robot: RobotLimits,
        noise: OdometryNoise,
        world: World,
        command: Command,
        shock: Float[Array, "3"],
        dt: Float[Array, ""],
    ) -> World:
        """The world one control step later. shock: standard normal numbers for the base's random walk."""


class Kinematic(Fidelity):
    """Commanded velocities within the drives' limits, integrated on SE(2) and the joints."""

    def begin(self, world: World) -> World:
        """Nothing is missing."""
        return world

    def step(self, robot, noise, world, command, shock, dt) -> World:
        """Wheels and joints have the speeds that they are told, within their accelerations."""
        wheels = drive(
            robot.drive, world.wheels, command.base_twist, command.steer_twist, RIM_ACCELERATION, dt
        )
        rolled = robot.drive.twist(wheels.angle, wheels.speed)
        base, odometry = rolled_base(robot, noise, world, wheels.angle, wheels.speed, rolled, shock, dt)
        change = robot.arm_acceleration * dt
        velocity = world.arm_velocity + jnp.clip(command.arm_velocity - world.arm_velocity, -change, change)
        velocity = jnp.clip(velocity, -robot.arm_speed, robot.arm_speed)
        arm = jnp.clip(world.arm + velocity * dt, robot.arm_lower, robot.arm_upper)
        return World(base, arm, velocity, wheels, odometry, world.slip, world.servos)


def rolled_base(
    robot: RobotLimits,
    noise: OdometryNoise,
    world: World,
    angle: Float[Array, "w"],
    rim: Float[Array, "w"],
    rolled: Float[Array, "3"],
    shock: Float[Array, "3"],
    dt: Float[Array, ""],
) -> tuple[Float[Array, "3"], Float[Array, "3"]]:
    """The true base and the one that odometry believes, after a step in which the wheels rolled the twist
    `rolled`.

    angle: of the steering axes at the step's end [rad]. rim: speeds of the rims [m/s], which odometry sees
    above its dead band. Slip comes on top of what rolled.
    """
    turned = jnp.abs(angle - world.wheels.angle).mean()
    reported = robot.drive.twist(angle, reported_speed(noise, rim))
    base = moved(world.base, true_motion(noise, world.slip, rolled, turned, shock, dt))
    return base, moved(world.odometry, reported * dt)
