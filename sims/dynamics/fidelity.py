"""Fidelity `dynamic`: a planar base and an arm under servos, by MJX."""

import dataclasses
from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import mujoco
from jaxtyping import Array, Bool, Float

from opt.wbc import RobotLimits
from sims.driver import drive
from sims.dynamics.arm_servos import arm_holds, arm_reference
from sims.dynamics.engine import Engine
from sims.dynamics.model import planar_model
from sims.dynamics.parameters import GRAVITY_ERROR, POSITION_RATE, Physics, physics_of
from sims.dynamics.servos import load_of
from sims.worlds import RIM_ACCELERATION, Fidelity, World, rolled_base

# Physics steps in a control step of 20 ms.
SUBSTEPS = 4


class Servos(NamedTuple):
    """What the physics knows beyond a `World`: how the base rolls and is told to (v_x, v_y, w) in its own
    frame, and where the arm's servos are told to be, and how fast.
    """

    rolling: Float[Array, "3"]
    told: Float[Array, "3"]
    reference: Float[Array, "a"]
    reference_velocity: Float[Array, "a"]


class Dynamic(Fidelity):
    """Base and arm have masses, and servos that follow what they are told with the forces they have.

    The base's velocity servos follow the twist that its wheels, within the drives' limits, are told to roll,
    its acceleration fed forward. What they really roll is what odometry measures, above its dead band, and
    what slip acts on, once: the physics knows no slip. The arm's controller integrates the commanded joint
    velocities, within the joints' accelerations, into a reference, which position servos follow with its
    velocity fed forward.

    The physics runs in the frame where the base stood at the beginning of the control step: the plane looks
    the same from everywhere, and small numbers round less. engine: compiled with the program. known: what
    the arm's own compensation of its weight takes for masses and gravity; None for what they are.
    """

    physics: Physics
    engine: Engine = eqx.field(static=True)
    substeps: int = eqx.field(static=True, default=SUBSTEPS)
    known: Physics | None = None

    def begin(self, world: World) -> World:
        """The world with servos at rest, unless it has them."""
        if isinstance(world.servos, Servos):
            return world
        still = jnp.zeros_like(world.base)
        at_rest = Servos(still, still, world.arm, jnp.zeros_like(world.arm))
        return dataclasses.replace(world, servos=at_rest)

    def step(self, robot, noise, world, command, shock, dt) -> World:
        """One control step: `substeps` steps of physics."""
        wheels, motion = drive(
            robot.drive, world.wheels, command.base_twist, command.steer_twist, RIM_ACCELERATION, dt
        )
        told = robot.drive.odometry(motion).twist
        way, arm, arm_velocity, servos = self._physics(robot, world, told, command.arm_velocity, dt)
        # Tyres hold sideways: the base keeps what its wheels can roll, as a wheel's own lag must not become
        # sliding that odometry cannot see.
        at_end = motion._replace(speed=robot.drive.rolled(servos.rolling, motion.angle))
        servos = servos._replace(rolling=robot.drive.odometry(at_end).twist)
        motion = motion._replace(speed=robot.drive.rolled(way / dt, motion.angle))
        moved_on = rolled_base(robot, noise, world, wheels, motion, shock, dt)
        return dataclasses.replace(moved_on, arm=arm, arm_velocity=arm_velocity, servos=servos)

    def holds(self, robot: RobotLimits, world: World) -> Bool[Array, ""]:
        """Whether the arm is no faster than arms can be."""
        del robot
        return arm_holds(world.arm_velocity)

    def _physics(self, robot: RobotLimits, world: World, told, arm_velocity, dt):
        """Displacement of the base at its mean heading (x, y [m], yaw [rad]), the arm, and the servos."""
        p, h, base = self.physics, dt / self.substeps, jnp.zeros_like(world.base)
        model = self.engine.with_physics(p, h)
        q = jnp.concatenate([base, world.arm])
        v = jnp.concatenate([world.servos.rolling, world.arm_velocity])

        load = None if self.known is None else load_of(self.known)
        before = world.servos.told
        push = p.pushed * (told - before) / dt

        def substep(state, share):
            q, v, goal, pace = state
            goal, pace = arm_reference(robot, q[3:], goal, pace, arm_velocity, h)
            wanted = before + share * (told - before)
            base = _turned(p.velocity_gain[:3] * wanted + push, q[2])
            arm = p.position_gain * goal + p.velocity_gain[3:] * pace
            ctrl = jnp.concatenate([base, arm])
            q, v = self.engine.advance(model, q, v, ctrl, 1 - p.gravity_error, load)
            return (q, v, goal, pace), None

        start = (q, v, world.servos.reference, world.servos.reference_velocity)
        shares = jnp.arange(1, self.substeps + 1).astype(dt.dtype) / self.substeps
        (q, v, goal, pace), _ = jax.lax.scan(substep, start, shares)
        servos = Servos(_turned(v[:3], -q[2]), told, goal, pace)
        return _turned(q[:3], -q[2] / 2), q[3:], v[3:], servos


def _turned(twist: Float[Array, "3"], angle: Float[Array, ""]) -> Float[Array, "3"]:
    """(x, y, w) with x and y turned by an angle."""
    c, s = jnp.cos(angle), jnp.sin(angle)
    return jnp.stack([c * twist[0] - s * twist[1], s * twist[0] + c * twist[1], twist[2]])


def dynamic(
    model: mujoco.MjModel,
    *,
    substeps: int = SUBSTEPS,
    position_rate: float = POSITION_RATE,
    gravity_error: float = GRAVITY_ERROR,
) -> Dynamic:
    """The fidelity `dynamic` of a robot's compiled model (`sims.robots.robot_model`).

    substeps: of physics in a control step. position_rate [1/s], gravity_error: see `Physics`.
    """
    planar = planar_model(model)
    physics = physics_of(planar, position_rate=position_rate, gravity_error=gravity_error)
    return Dynamic(physics, Engine(planar), substeps)
