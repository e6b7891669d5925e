"""One simulated robot: its true state, and what advances it by one control step."""

import abc
import dataclasses

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, PyTree

from jaxpaint.localisation import Belief
from jaxpaint.steering import WheelMotion
from opt.controller import Command, Measured
from opt.wbc import RobotLimits
from sims.driver import Wheels, at_rest, drive
from sims.odometry import OdometryNoise, Slip, displacement, moved, reported_speed, wandering

# Acceleration of the rims [m/s^2]: the drives' own limit, above what any controller asks for.
RIM_ACCELERATION = 2.0


class World(eqx.Module):
    """The truth. base: pose (x, y, yaw) in the map. arm, arm_velocity: joints. wheels: angles, and rim speeds
    as the drives are told. odometry: the base pose that odometry alone believes. belief: what the robot
    believed when it last looked, anchor: odometry then, steered: how far the modules have turned since
    [rad]. slip: this world's own errors. residual: of the last step's odometry, by how much the wheels
    disagreed on a twist [m/s]. tilt: height of the base over the plane z = 0 [m], roll and pitch [rad], which
    nobody measures; 0 where a fidelity knows the plane alone. servos: what only its fidelity knows.
    """

    base: Float[Array, "3"]
    arm: Float[Array, "a"]
    arm_velocity: Float[Array, "a"]
    wheels: Wheels
    odometry: Float[Array, "3"]
    belief: Belief
    anchor: Float[Array, "3"]
    steered: Float[Array, ""]
    slip: Slip
    residual: Float[Array, ""]
    tilt: Float[Array, "3"]
    servos: PyTree = ()

    @property
    def believed(self) -> Float[Array, "3"]:
        """Where the robot takes its base to be: the last look's belief, and odometry since."""
        return moved(self.belief.pose, displacement(self.anchor, self.odometry))

    def measured(self) -> Measured:
        """All that a controller may see of it."""
        return Measured(self.believed, self.arm, self.wheels.angle)


def standing(base: Float[Array, "3"], arm: Float[Array, "a"], slip: Slip, wheels: int) -> World:
    """A robot at rest that knows where it is."""
    still, zero = at_rest(jnp.zeros((wheels,), base.dtype)), jnp.zeros((), base.dtype)
    known = Belief(base, jnp.zeros((3, 3), base.dtype))
    level = jnp.zeros_like(base)
    return World(base, arm, jnp.zeros_like(arm), still, base, known, base, zero, slip, zero, level)


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

    def holds(self, robot: RobotLimits, world: World) -> Bool[Array, ""]:
        """Whether the world can still be meant, or has left all that its model is about: then it diverged."""
        del robot, world
        return jnp.ones((), bool)


class Kinematic(Fidelity):
    """Commanded velocities within the drives' limits, integrated on SE(2) and the joints."""

    def begin(self, world: World) -> World:
        """Nothing is missing."""
        return world

    def step(self, robot, noise, world, command, shock, dt) -> World:
        """Wheels and joints have the speeds that they are told, within their accelerations."""
        wheels, motion = drive(
            robot.drive, world.wheels, command.base_twist, command.steer_twist, RIM_ACCELERATION, dt
        )
        world = rolled_base(robot, noise, world, wheels, motion, shock, dt)
        change = robot.arm_acceleration * dt
        velocity = world.arm_velocity + jnp.clip(command.arm_velocity - world.arm_velocity, -change, change)
        velocity = jnp.clip(velocity, -robot.arm_speed, robot.arm_speed)
        arm = jnp.clip(world.arm + velocity * dt, robot.arm_lower, robot.arm_upper)
        return dataclasses.replace(world, arm=arm, arm_velocity=velocity)


def rolled_base(
    robot: RobotLimits,
    noise: OdometryNoise,
    world: World,
    wheels: Wheels,
    motion: WheelMotion,
    shock: Float[Array, "3"],
    dt: Float[Array, ""],
) -> World:
    """The world after a step in which the wheels moved so: base, odometry and wheels have moved.

    wheels: at the step's end. motion: as measured; odometry does not see rims below its dead band, steering
    axes always. The true wheels differ from it by the world's slip, and what they roll is the twist that fits
    them best.
    """
    turned = jnp.abs(wheels.angle - world.wheels.angle).mean()
    slip = world.slip
    true = motion._replace(angle=motion.angle + slip.steering, speed=motion.speed * (1 + slip.radius))
    rolled = robot.drive.odometry(true).twist
    read = motion._replace(speed=reported_speed(noise, motion.speed))
    reported, residual = robot.drive.odometry(read)
    return dataclasses.replace(
        world,
        base=moved(world.base, rolled * dt + wandering(noise, rolled, turned, shock, dt)),
        odometry=moved(world.odometry, reported * dt),
        wheels=wheels,
        steered=world.steered + turned,
        residual=residual,
    )
