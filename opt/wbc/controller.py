"""The closed-loop whole-body controller: tasks and limits add up to one QP, S1-(10) to (13)."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from jaxpaint.decisions.halting import HaltState, initial_halt
from jaxpaint.decisions.thresholds import Thresholds
from jaxpaint.kinematics.chain import KinematicChain, jacobian
from jaxpaint.kinematics.manipulability import manipulability_gradient
from jaxpaint.steering import AbstractDrive
from opt.controller import Command, Controller, Decision, Measured
from opt.plan import Samples
from opt.qp import QuadraticProgram, solve_qp
from opt.wbc.base_motion import BaseDemand, Situation, body_twist, demand_base
from opt.wbc.limits import Bounds, damped, demanded_motion_bounds, joined, speed_bounds, within_acceleration
from opt.wbc.settings import ControllerSettings
from opt.wbc.task import Reference, brush_rows

QP_ITERATIONS = 9


class RobotLimits(eqx.Module):
    """What a controller knows of the robot.

    home: brush in the base frame at the best posture (x, y) [m]. Base limits are of (x, y, yaw) in the map
    frame [m/s, rad/s, m/s^2, rad/s^2]; arm limits of the joints [rad, rad/s, rad/s^2].
    """

    chain: KinematicChain
    drive: AbstractDrive
    home: Float[Array, "2"]
    base_speed: Float[Array, "3"]
    base_acceleration: Float[Array, "3"]
    arm_lower: Float[Array, "a"]
    arm_upper: Float[Array, "a"]
    arm_speed: Float[Array, "a"]
    arm_acceleration: Float[Array, "a"]


class Memory(eqx.Module):
    """The latch, the last commanded velocities (base in the map frame), and the base pose last seen."""

    halt: HaltState
    base_velocity: Float[Array, "3"]
    arm_velocity: Float[Array, "a"]
    last_base: Float[Array, "3"]


class WholeBodyController(Controller):
    """Follows a brush path with base and arm together.

    reference: rows of position, rotation by rows, velocity, angular velocity, pen, in the map frame.
    stations: base poses (x, y, yaw) for what comes next. speed: the path's nominal speed [m/s]. pace: share
    of the planned speed at which the path is followed.
    """

    robot: RobotLimits
    settings: ControllerSettings
    thresholds: Thresholds
    reference: Samples
    stations: Samples
    speed: Float[Array, ""]
    pace: Float[Array, ""]
    duration: Float[Array | np.ndarray, ""]

    def initial(self, measured: Measured) -> Memory:
        """A controller at rest."""
        return Memory(
            initial_halt(measured.base.dtype),
            jnp.zeros_like(measured.base),
            jnp.zeros_like(measured.arm),
            measured.base,
        )

    def decide(self, memory: Memory, measured: Measured, clock, dt) -> tuple[Decision, Memory]:
        """One control step: decide on the base, add up the program, solve it."""
        pose, jac = jacobian(self.robot.chain, jnp.concatenate([measured.base, measured.arm]))
        planned = read_reference(self.reference, clock)
        error = _length(planned.position - pose.p)
        rate = self.pace * jnp.clip(2 - 2 * error / self.settings.hold_error, 0.0, 1.0)
        reference = planned._replace(
            velocity=planned.velocity * rate, angular_velocity=planned.angular_velocity * rate
        )
        demand = self._demand(memory, measured, reference, self.stations.at(clock), dt)
        rows = brush_rows(pose.p, pose.R, jac, reference, self.settings)
        cost, linear = self._costs(jac, demand)
        bounds = joined(self._base_bounds(memory, demand, dt), self._arm_bounds(memory, measured, dt))
        program = QuadraticProgram(cost, linear, rows.jacobian, rows.target, rows.slack_cost, *bounds)
        solution = solve_qp(program, smoothing=self.settings.qp_smoothing, iterations=QP_ITERATIONS)
        base, arm = solution.value[:3], solution.value[3:]
        command = self._command(base, arm, demand, measured)
        halted = demand.halt.halted
        decision = Decision(command, rate, planned.position, planned.pen, halted, solution.status)
        return decision, Memory(demand.halt, base, arm, measured.base)

    def _demand(self, memory: Memory, measured: Measured, reference: Reference, station, dt) -> BaseDemand:
        axis, step, lever = (
            reference.rotation[:, 2],
            measured.base - memory.last_base,
            self.settings.yaw_lever,
        )
        situation = Situation(
            base=measured.base,
            station=station,
            home=self.robot.home,
            brush=reference.position[:2],
            heading=jnp.arctan2(axis[1], axis[0]),
            speed=jnp.maximum(self.speed, _length(reference.velocity)),
            travelled=_length(jnp.stack([step[0], step[1], lever * step[2]])),
        )
        return demand_base(
            situation,
            measured.wheel_angle,
            self.robot.drive,
            self.robot.base_speed,
            memory.halt,
            self.thresholds,
            self.settings,
            dt,
        )

    def _costs(
        self, jac: Float[Array, "6 n"], demand: BaseDemand
    ) -> tuple[Float[Array, "n"], Float[Array, "n"]]:
        """Diagonal of M and C of S1-(10): effort, the demanded base motion, manipulability."""
        s = self.settings
        climb = manipulability_gradient(jac[:, 3:], damping=1e-4)[1]
        follow = jnp.where(self.thresholds.low_speed_scale > 0, s.base_follow, 0.0)
        cost = jnp.concatenate([s.base_effort + follow, s.arm_effort])
        return cost, jnp.concatenate([-follow * demand.velocity * demand.gate, -s.manipulability * climb])

    def _arm_bounds(self, memory: Memory, measured: Measured, dt) -> Bounds:
        r, s = self.robot, self.settings
        bounds = speed_bounds(r.arm_speed * s.arm_speed)
        bounds = damped(bounds, measured.arm, r.arm_lower, r.arm_upper, s.damper_start, s.damper_stop)
        return within_acceleration(bounds, memory.arm_velocity, r.arm_acceleration * dt)

    def _base_bounds(self, memory: Memory, demand: BaseDemand, dt) -> Bounds:
        ruled = self.thresholds.low_speed_scale > 0
        follow, free = (
            demanded_motion_bounds(demand.velocity, demand.gate),
            self.robot.base_speed * demand.gate,
        )
        bounds = Bounds(jnp.where(ruled, follow.lower, -free), jnp.where(ruled, follow.upper, free))
        return within_acceleration(bounds, memory.base_velocity, self.robot.base_acceleration * dt)

    def _command(self, base: Float[Array, "3"], arm, demand: BaseDemand, measured: Measured) -> Command:
        """With the low-speed rule the wheels turn before the base moves; without, while it moves."""
        ahead = jnp.where(self.thresholds.low_speed_scale > 0, demand.velocity * demand.steer, base)
        yaw = measured.base[2]
        return Command(body_twist(base, yaw), body_twist(ahead, yaw), arm)


def read_reference(samples: Samples, clock: Float[Array, ""]) -> Reference:
    """The reference at plan time `clock`."""
    row = samples.at(clock)
    return Reference(row[:3], row[3:12].reshape(3, 3), row[12:15], row[15:18], row[18])


def _length(vector: Float[Array, "n"]) -> Float[Array, ""]:
    return jnp.sqrt((vector**2).sum() + 1e-14)
