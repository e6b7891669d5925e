"""Adds tasks and limits up to the one quadratic program of a control step, S1-(10) and (11)."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from jaxpaint.decisions.thresholds import Thresholds
from jaxpaint.kinematics import Pose, own_gap_slope, plane_gap_slope
from opt.qp import QuadraticProgram, quadratic_program
from opt.wbc.base_motion import BaseDemand
from opt.wbc.limits import (
    Clearance,
    as_bounds_allow,
    clearance,
    damper_bounds,
    is_signed,
    low_speed_bounds,
    nonholonomic,
    nonholonomic_rows,
    possible_part,
    speed_bounds,
    with_braking,
    within_acceleration,
)
from opt.wbc.pieces import Bounds, joined, met, no_rows, stacked, summed
from opt.wbc.reference import Reference
from opt.wbc.robot import RobotLimits
from opt.wbc.settings import ControllerSettings
from opt.wbc.tasks import base_follow, brush_twist, climb, effort


class Step(eqx.Module):
    """What the program of one control step of length dt [s] looks at.

    links: frames of the chain, pose: of the brush, jacobian: there, all in the map frame. arm: encoders
    [rad]. yaw: of the base by odometry [rad]. base_velocity (map frame), arm_velocity: last commanded. awake:
    false where the robot gave up: its base stands still, its arm goes to the joints `best` [rad].
    """

    links: Pose
    pose: Pose
    jacobian: Float[Array, "6 n"]
    reference: Reference
    demand: BaseDemand
    arm: Float[Array, "a"]
    yaw: Float[Array, ""]
    base_velocity: Float[Array, "3"]
    arm_velocity: Float[Array, "a"]
    awake: Bool[Array, ""]
    best: Float[Array, "a"]
    dt: Float[Array, ""]


def control_program(
    step: Step, robot: RobotLimits, settings: ControllerSettings, thresholds: Thresholds
) -> QuadraticProgram:
    """min 1/2 q'Mq + C'q + 1/2 s'R^-1 s  subject to  Jq + s = v,  Aq <= B,  Q'min <= q <= Q'max.

    q: velocities, the base's (x, y, yaw in the map frame) first, then the arm's. Shapes depend on the robot
    alone: a term that is left out keeps its rows, which then ask for nothing.
    """
    base = robot.base_size
    way = nonholonomic_rows(robot.drive, step.yaw)[: None if base else 0]
    objectives = [effort(settings, base), climb(step.jacobian, settings, base)]
    equalities = [brush_twist(step.pose, step.jacobian, step.reference, settings)]
    clear = clearances(step, robot, settings)
    bounds = arm_bounds(step, clear.speed_share, robot, settings)
    if base:
        objectives.append(base_follow(_demanded(step), is_signed(thresholds), settings, robot.arm_joints))
        equalities.append(nonholonomic(way, settings.nonholonomic, robot.arm_joints))
        bounds = joined(base_bounds(step, way, robot, settings, thresholds), bounds)
    below = as_bounds_allow(clear.row, bounds)
    cost, task = summed(objectives), stacked(equalities)
    return quadratic_program(
        cost.hessian,
        cost.linear,
        jacobian=task.rows,
        target=task.target,
        compliance=task.compliance,  # pyright: ignore[reportArgumentType]
        rows=below.rows,
        limit=below.limit,
        lower=bounds.lower,  # pyright: ignore[reportArgumentType]
        upper=bounds.upper,  # pyright: ignore[reportArgumentType]
    )


def _demanded(step: Step) -> Float[Array, "3"]:
    return step.demand.velocity * step.demand.gate


def arm_bounds(
    step: Step, share: Float[Array, ""], robot: RobotLimits, settings: ControllerSettings
) -> Bounds:
    """Speed, of which clearance leaves a share, dampers, acceleration; one speed where the robot gave up."""
    speed = robot.arm_speed * settings.arm_speed * share
    back = jnp.clip(settings.position_gain * (step.best - step.arm), -speed, speed)
    allowed = Bounds(*(jnp.where(step.awake, x, back) for x in speed_bounds(speed)))
    damping = robot.arm_speed * jnp.minimum(settings.arm_speed, 1.0)
    dampers = damper_bounds(
        step.arm, robot.arm_lower, robot.arm_upper, damping, settings.damper_start, settings.damper_stop
    )
    change = robot.arm_acceleration * settings.arm_acceleration * step.dt
    return within_acceleration(met([allowed, dampers]), step.arm_velocity, change)


def base_bounds(
    step: Step,
    way: Float[Array, "k 3"],
    robot: RobotLimits,
    settings: ControllerSettings,
    thresholds: Thresholds,
) -> Bounds:
    """Speed and the low-speed rule, acceleration. way: rows that the base cannot leave."""
    demand, speed = step.demand, robot.base_speed * settings.base_speed
    rule = low_speed_bounds(
        demand.velocity, demand.gate * step.awake, step.reference.velocity, speed, thresholds
    )
    change = robot.base_acceleration * settings.base_acceleration * step.dt
    velocity = possible_part(way, step.base_velocity)
    bounds = within_acceleration(met([speed_bounds(speed), rule]), velocity, change)
    return with_braking(bounds, way, velocity, change)


def clearances(step: Step, robot: RobotLimits, settings: ControllerSettings) -> Clearance:
    """The robot clear of itself, and of the wall: the plane at the brush's reference stands for it, since
    that is all that the controller knows of the wall. A plane that recedes may be followed.
    """
    s, parts = settings, robot.parts
    rows, share = no_rows(robot.chain.size, step.jacobian.dtype), jnp.ones_like(step.dt)
    if parts.pairs:
        own = own_gap_slope(robot.chain, parts, step.links, s.gap_blend)
        found = clearance(own, s.own_approach, s.own_start, s.own_stop)
        rows, share = stacked([rows, found.row]), jnp.minimum(share, found.speed_share)
    if sum(parts.skin.count):
        place, axis = step.reference.position, step.reference.rotation[:, 2]
        spread = s.wall_reach, s.gap_blend
        wall = plane_gap_slope(robot.chain, parts.skin, step.links, place, axis, *spread)
        found = clearance(wall, s.wall_approach, s.wall_start, s.wall_stop)
        recedes = jnp.maximum((step.reference.velocity * axis).sum(), 0.0)
        row = found.row._replace(limit=found.row.limit + recedes)
        rows, share = stacked([rows, row]), jnp.minimum(share, found.speed_share)
    return Clearance(rows, share)
