"""Fidelity `wheeled`: a free base on steered, driven wheels in contact with the floor, by MJX."""

import dataclasses
from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import mujoco
import numpy as np
from jaxtyping import Array, Bool, Float

from jaxpaint.steering import WheelMotion
from opt.wbc import RobotLimits
from sims.driver import Wheels, at_rest, drive
from sims.dynamics.arm_servos import arm_holds, arm_reference, leashed
from sims.dynamics.servos import load_of
from sims.odometry import displacement, moved, reported_speed
from sims.wheeled.attitude import Placed, from_free_joint, to_free_joint
from sims.wheeled.engine import Motion, WheeledEngine
from sims.wheeled.floors import Floor
from sims.wheeled.model import wheeled_model
from sims.wheeled.parameters import WheeledPhysics, wheeled_physics
from sims.wheeled.rest import at_rest as robot_at_rest
from sims.worlds import RIM_ACCELERATION, Fidelity, World

# Physics steps in a control step of 20 ms.
SUBSTEPS = 4
# A base this high or low [m], or tilted so far [rad], stands on its wheels no more; one that is so many times
# as fast as it may be told to go is not driven; nor is one that slid so far [m] in about so long [s].
_TILTED, _FAST, _SLID, _FORGOTTEN = (0.3, 0.5, 0.5), 4.0, 0.2, 5.0


class Servos(NamedTuple):
    """What the physics knows beyond a `World`. speed: of the free joint (linear in the map, angular in the
    base) and of all others. acceleration: the last. told: where steering axes are told to be, and rims to
    roll. steering: true angles of the axes [rad]. ahead: by how much each axle was told to turn more than it
    did [rad]. reference, reference_velocity: of the arm. slid: how far the base lately slid on its wheels
    [m].
    """

    speed: Float[Array, " nv"]
    acceleration: Float[Array, " nv"]
    told: Wheels
    steering: Float[Array, " w"]
    ahead: Float[Array, " w"]
    reference: Float[Array, " a"]
    reference_velocity: Float[Array, " a"]
    slid: Float[Array, ""]


class _Goals(NamedTuple):
    """Of the steering axes, the axles and the arm: where they are told to be [rad], and how fast [rad/s]."""

    steer: Float[Array, " w"]
    axle: Float[Array, " w"]
    arm: Float[Array, " a"]
    pace: Float[Array, " a"]


class Wheeled(Fidelity):
    """Drives and arm have servos; the base goes where its wheels take it, as friction has it.

    Odometry is what the encoders of steering axes and axles count, above its dead band. A world's `Slip` is
    in its wheels: each axis stands askew by its part, and each wheel rolls further than its encoder counts.
    The random walk of `OdometryNoise` is left out: what makes wheels slip is here. The arm is as in
    `Dynamic`. tilt: at rest; rolling_radius: see `sims.wheeled.rest.Rest`. engine: compiled with the program.
    known: as in `Dynamic`.
    """

    physics: WheeledPhysics
    tilt: Float[Array, "3"]
    rolling_radius: Float[Array, ""]
    engine: WheeledEngine = eqx.field(static=True)
    substeps: int = eqx.field(static=True, default=SUBSTEPS)
    known: WheeledPhysics | None = None

    def begin(self, world: World) -> World:
        """The world standing on its wheels, all at rest, unless it stands already."""
        if isinstance(world.servos, Servos):
            return world
        count = self.physics.velocity_gain.shape[0]
        still = jnp.zeros((6 + count,), world.base.dtype)
        angle = world.wheels.angle
        rest = Servos(
            speed=still,
            acceleration=still,
            told=at_rest(angle),
            steering=angle + world.slip.steering,
            ahead=jnp.zeros_like(angle),
            reference=world.arm,
            reference_velocity=jnp.zeros_like(world.arm),
            slid=jnp.zeros_like(world.residual),
        )
        return dataclasses.replace(world, tilt=self.tilt.astype(world.base.dtype), servos=rest)

    def step(self, robot, noise, world, command, shock, dt) -> World:
        """One control step: `substeps` steps of physics."""
        del shock
        s: Servos = world.servos
        told, _ = drive(robot.drive, s.told, command.base_twist, command.steer_twist, RIM_ACCELERATION, dt)
        motion, goals = self._physics(robot, world, told, command.arm_velocity, dt)
        placed = from_free_joint(motion.q[:7], world.base[2])
        wheels = len(told.angle)
        steering, turned, arm = _parts(motion.q[7:], wheels)
        counted = Wheels(steering - world.slip.steering, turned * self._way(world) / dt, told.way)
        odometry, residual, swept = _counted(robot, noise, world, counted, dt)
        rolled = _rolled(robot, world, steering, turned * self.rolling_radius / dt)
        slid = displacement(world.base, placed.base) - rolled * dt
        servos = Servos(
            speed=motion.v,
            acceleration=motion.a,
            told=told,
            steering=steering,
            ahead=leashed(turned, goals.axle) - turned,
            reference=goals.arm,
            reference_velocity=goals.pace,
            slid=s.slid * (1 - dt / _FORGOTTEN) + jnp.abs(slid[:2]).max(),
        )
        return dataclasses.replace(
            world,
            base=placed.base,
            tilt=placed.tilt,
            arm=arm,
            arm_velocity=_parts(motion.v[6:], wheels)[2],
            wheels=counted,
            odometry=odometry,
            steered=world.steered + swept,
            residual=residual,
            servos=servos,
        )

    def holds(self, robot: RobotLimits, world: World) -> Bool[Array, ""]:
        """Whether the base stands on the floor, goes no faster than it ever could, and goes where its wheels
        roll: without friction they turn, and it stays.
        """
        s: Servos = world.servos
        upright = (jnp.abs(world.tilt) < jnp.asarray(_TILTED, world.tilt.dtype)).all()
        slow = (jnp.abs(s.speed[:3]) < _FAST * robot.base_speed.max()).all()
        return upright & slow & (s.slid < _SLID) & arm_holds(world.arm_velocity)

    def _way(self, world: World) -> Float[Array, " w"]:
        """What encoders count for a turn of one radian [m]."""
        return self.rolling_radius / (1 + world.slip.radius)

    def _physics(self, robot: RobotLimits, world: World, told: Wheels, arm_velocity, dt):
        """The robot and its goals after the control step; axles begin it at angle 0."""
        p, h, s = self.physics, dt / self.substeps, world.servos
        model = self.engine.with_physics(p, h)
        before, zero = s.told, jnp.zeros_like(s.ahead)
        rate, way = (told.angle - before.angle) / dt, self._way(world)
        push = p.pushed * self.rolling_radius * (told.speed - before.speed) / dt / zero.shape[0]
        # Each arm joint's weight is balanced but for the error; wheels have none.
        load = None if self.known is None else load_of(self.known)
        balanced = _joined(zero, zero, jnp.ones_like(world.arm) * (1 - p.gravity_error))

        def substep(state, share):
            motion, goals = state
            steering, turned, arm = _parts(motion.q[7:], zero.shape[0])
            spin = (before.speed + share * (told.speed - before.speed)) / way
            goal, pace = arm_reference(robot, arm, goals.arm, goals.pace, arm_velocity, h)
            goals = _Goals(goals.steer + rate * h, leashed(turned, goals.axle + spin * h), goal, pace)
            place = _joined(leashed(steering, goals.steer), goals.axle, goal)
            ctrl = p.position_gain * place + p.velocity_gain * _joined(rate, spin, pace)
            ctrl = ctrl + _joined(zero, push, jnp.zeros_like(goal))
            return (self.engine.advance(model, motion, ctrl, balanced, load), goals), None

        free = to_free_joint(Placed(world.base, world.tilt))
        q = jnp.concatenate([free, _joined(s.steering, zero, world.arm)])
        goals = _Goals(before.angle + world.slip.steering, s.ahead, s.reference, s.reference_velocity)
        shares = jnp.arange(1, self.substeps + 1).astype(dt.dtype) / self.substeps
        state, _ = jax.lax.scan(substep, (Motion(q, s.speed, s.acceleration), goals), shares)
        return state


def _counted(robot: RobotLimits, noise, world: World, after: Wheels, dt):
    """Odometry's pose, what wheels disagreed by [m/s], and how far the axes turned [rad], by the encoders."""
    angle, turned = (world.wheels.angle + after.angle) / 2, after.angle - world.wheels.angle
    read = WheelMotion(angle, reported_speed(noise, after.speed), turned / dt)
    twist, residual = robot.drive.odometry(read)
    return moved(world.odometry, twist * dt), residual, jnp.abs(turned).mean()


def _rolled(robot: RobotLimits, world: World, steering: Float[Array, " w"], speed: Float[Array, " w"]):
    """The twist of a base that does not slip, by what its wheels truly did. speed: of the rims [m/s]."""
    angle = (world.servos.steering + steering) / 2
    return robot.drive.odometry(WheelMotion(angle, speed, jnp.zeros_like(speed))).twist


def _parts(joints: Float[Array, " n"], wheels: int) -> tuple[Array, Array, Array]:
    """Steering axes, axles, arm; of joints in the model's order: each wheel's axis and axle, then the arm."""
    pairs = joints[: 2 * wheels].reshape(wheels, 2)
    return pairs[:, 0], pairs[:, 1], joints[2 * wheels :]


def _joined(steer: Float[Array, " w"], axle: Float[Array, " w"], arm: Float[Array, " a"]):
    """The inverse."""
    return jnp.concatenate([jnp.stack([steer, axle], axis=1).reshape(-1), arm])


def wheeled(
    model: mujoco.MjModel,
    home: Float[np.ndarray, " arm"],
    *,
    floor: Floor | None = None,
    friction: float | None = None,
    substeps: int = SUBSTEPS,
) -> Wheeled:
    """The fidelity `wheeled` of a robot's compiled model (`sims.robots.robot_model`).

    home: the arm's posture [rad] with which the base, at rest, is at height 0. friction: of the floor [-].
    Raises InputError for a robot whose wheels are not steered.
    """
    sunk = robot_at_rest(wheeled_model(model), home)
    rolling = wheeled_model(model, floor, height=-float(sunk.tilt[0]))
    physics = wheeled_physics(rolling) if friction is None else wheeled_physics(rolling, friction=friction)
    level = jnp.asarray([0.0, *sunk.tilt[1:]])
    return Wheeled(physics, level, jnp.asarray(sunk.rolling_radius), WheeledEngine(rolling), substeps)
