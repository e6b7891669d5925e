"""The closed-loop whole-body controller: tasks and limits add up to one QP, S1-(10) to (13)."""

from enum import IntEnum

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from jaxpaint.decisions.halting import HaltState, initial_halt
from jaxpaint.decisions.thresholds import Thresholds
from jaxpaint.kinematics import frames, tool_jacobian
from opt.controller import Command, Controller, Decision, Measured, Surface
from opt.plan import Samples
from opt.qp import QPSolution, QPStatus, QuadraticProgram, solve_qp
from opt.wbc.base_motion import BaseDemand, Situation, base_at_rest, body_twist, demand_base
from opt.wbc.limits import braked, is_signed
from opt.wbc.patience import Waiting, not_waiting, update_waiting
from opt.wbc.program import Step, control_program
from opt.wbc.reference import Reference, read_reference
from opt.wbc.robot import RobotLimits
from opt.wbc.settings import ControllerSettings

# All of them, whatever the program: 9 leave one step in a thousand unsolved, 12 none of 400,000.
QP_ITERATIONS = 12


class ControlStatus(IntEnum):
    """How a control step ended: as its program did, or given up."""

    SOLVED = QPStatus.SOLVED
    INFEASIBLE = QPStatus.INFEASIBLE  # violates hard rows least; stands still where bounds contradict
    NOT_CONVERGED = QPStatus.NOT_CONVERGED  # goes on with the last iterate
    NOT_FINITE = QPStatus.NOT_FINITE  # stands still, here and below
    NOT_CONVEX = QPStatus.NOT_CONVEX
    UNBOUNDED = QPStatus.UNBOUNDED
    OUT_OF_REACH = max(QPStatus) + 1  # the patience is spent: goes back to where it was nearest


class Memory(eqx.Module):
    """The latch, the last commanded velocities (base in the map frame), the base pose last seen, and how long
    the plan's clock has waited.
    """

    halt: HaltState
    base_velocity: Float[Array, "3"]
    arm_velocity: Float[Array, "a"]
    last_base: Float[Array, "3"]
    waiting: Waiting


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
        dtype = measured.base.dtype
        return Memory(
            initial_halt(dtype),
            jnp.zeros_like(measured.base),
            jnp.zeros_like(measured.arm),
            measured.base,
            not_waiting(measured.arm),
        )

    def surface(self, clock) -> Surface:
        """Where the brush is to touch, while the pen is down."""
        now = read_reference(self.reference, clock)
        return Surface(now.position, -now.rotation[:, 2], (now.pen > 0.5).astype(now.pen.dtype))

    def decide(self, memory: Memory, measured: Measured, clock, dt) -> tuple[Decision, Memory]:
        """One control step: decide on the base, add up the program, solve it."""
        robot, settings = self.robot, self.settings
        links = frames(robot.chain, robot.joints(measured.base, measured.arm))
        pose, jac = tool_jacobian(robot.chain, links)
        planned = read_reference(self.reference, clock)
        error = _length(planned.position - pose.p)
        in_time = jnp.clip(2 - 2 * error / settings.hold_error, 0.0, 1.0)
        pace = self.pace * in_time
        demand = self._demand(memory, measured, planned.at_rate(pace), self.stations.at(clock), dt)
        missing = jnp.where(demand.waits > 0, demand.left, error)
        waiting = update_waiting(memory.waiting, missing, measured.arm, in_time * (1 - demand.waits), dt)
        lost = waiting.time >= settings.patience
        rate = pace * (1 - demand.waits)
        reference = planned.at_rate(rate)
        step = Step(
            links=links,
            pose=pose,
            jacobian=jac,
            reference=reference,
            demand=demand,
            arm=measured.arm,
            yaw=measured.base[2],
            base_velocity=memory.base_velocity,
            arm_velocity=memory.arm_velocity,
            awake=~lost,
            best=waiting.best,
            dt=dt,
        )
        program = control_program(step, robot, settings, self.thresholds)
        solution = solve_qp(program, smoothing=settings.qp_smoothing, iterations=QP_ITERATIONS, fixed=True)
        base, arm = self._velocities(solution, program, step)
        command = self._command(base, arm, demand, measured, lost)
        sound = (solution.status == QPStatus.SOLVED) | (solution.status == QPStatus.NOT_CONVERGED)
        status = jnp.where(lost & sound, ControlStatus.OUT_OF_REACH, solution.status)
        decision = Decision(command, rate, planned.position, planned.pen, demand.halt.halted, status)
        return decision, Memory(demand.halt, base, arm, measured.base, waiting)

    def _demand(self, memory: Memory, measured: Measured, reference: Reference, station, dt) -> BaseDemand:
        if self.robot.base_size == 0:
            return base_at_rest(memory.halt)
        axis, lever = reference.rotation[:, 2], self.settings.yaw_lever
        way = measured.base - memory.last_base
        situation = Situation(
            base=measured.base,
            station=station,
            home=self.robot.home,
            brush=reference.position[:2],
            heading=jnp.arctan2(axis[1], axis[0]),
            pen=reference.pen,
            speed=jnp.maximum(self.speed, _length(reference.velocity)),
            travelled=_length(jnp.stack([way[0], way[1], lever * way[2]])),
        )
        return demand_base(
            situation,
            measured.wheel_angle,
            self.robot.drive,
            self.robot.base_speed * self.settings.base_speed,
            memory.halt,
            self.thresholds,
            self.settings,
            dt,
        )

    def _velocities(
        self, solution: QPSolution, program: QuadraticProgram, step: Step
    ) -> tuple[Float[Array, "3"], Float[Array, "a"]]:
        """Of base (map frame) and arm: the solution's, or braking where there is none to follow."""
        ordered = (program.lower <= program.upper).all()
        usable = ordered & (solution.status < QPStatus.NOT_FINITE)
        robot, s, base = self.robot, self.settings, self.robot.base_size
        still = jnp.zeros_like(step.base_velocity[base:])
        told = (jnp.concatenate([solution.value[:base], still]), solution.value[base:])
        change = jnp.concatenate([robot.base_acceleration * s.base_acceleration * step.dt, still])
        stop = (
            braked(step.base_velocity, change),
            braked(step.arm_velocity, robot.arm_acceleration * s.arm_acceleration * step.dt),
        )
        return jnp.where(usable, told[0], stop[0]), jnp.where(usable, told[1], stop[1])

    def _command(
        self, base: Float[Array, "3"], arm, demand: BaseDemand, measured: Measured, lost: Bool[Array, ""]
    ) -> Command:
        """With the low-speed rule the wheels turn before the base moves; without, while it moves."""
        ahead = jnp.where(is_signed(self.thresholds), demand.velocity * demand.steer, base)
        yaw = measured.base[2]
        return Command(body_twist(base, yaw), body_twist(jnp.where(lost, base, ahead), yaw), arm)


def _length(vector: Float[Array, "n"]) -> Float[Array, ""]:
    return jnp.sqrt((vector**2).sum() + 1e-14)
