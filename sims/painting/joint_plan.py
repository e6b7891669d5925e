"""A run as one planned joint trajectory: what a robot that is never wrong would do."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float

from sims.odometry import no_slip
from sims.painting.approach import approach
from sims.painting.convert import joints_for_brush
from sims.painting.drive import JointPlan
from sims.painting.job import Job
from sims.painting.mission import Mission
from sims.painting.scan import scan_motion, start_worlds
from sims.rollout import RECORD_EVERY
from sims.worlds import World, standing

_UNITS = {"hinge": "rad", "slide": "m"}
_PEN = -1
# The whole-body controller's plan ends on the way out: the robot comes to rest within this time [s], which is
# enough from 0.25 m/s, or else at this share of its acceleration.
_STOP, _BRAKING = 0.5, 0.95


@dataclasses.dataclass(frozen=True, eq=False)
class JointTrajectory:
    """Positions, velocities and accelerations of all joints, base first, in the map frame.

    units: of each joint's position, "m" or "rad". time: strictly increasing from zero [s]. pen: down.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    time: Float[np.ndarray, " t"]
    position: Float[np.ndarray, "t joints"]
    velocity: Float[np.ndarray, "t joints"]
    acceleration: Float[np.ndarray, "t joints"]
    pen: Bool[np.ndarray, " t"]


def planned_joint_trajectory(
    job: Job, mission: Mission, world: int, *, number: int | None = None
) -> JointTrajectory:
    """Scan, approach and painting of one world as the robot plans them from where it believes to stand.

    world: row of the mission's group. number: the world's index in the run, where that is another. Nothing
    slips: each part begins where the plan of the one before ends. The strokes are those that this world
    mapped. Accelerations that come and go at once are `eased`. Where one is beyond the robot's limit still,
    as of a base whose steered wheels turn while it speeds up, all takes longer by as much as that asks for.
    Raises ValueError where the plan has a number that is not finite.
    """
    index = np.array([world if number is None else number])
    painting = jax.tree.map(lambda x: np.asarray(x)[world : world + 1], mission.painting)
    start = start_worlds(job, index)
    wheels = start.wheels.angle.shape[-1]
    scan = scan_motion(job, start).plan
    there = approach(job, _resting(job, scan, wheels), painting).plan
    paint = joints_for_brush(job, painting.plan, _resting(job, there, wheels), jnp.asarray(index, jnp.int32))
    # A record's first row was taken before the last of its control steps.
    lag = (RECORD_EVERY - 1) * _seconds(job.dt)
    parts = [(scan, 0.0), (there, 0.0), (paint, lag)]
    broken = any(_rows_of(plan, lag) < 2 for plan, lag in parts)
    limit = np.asarray(job.robot.acceleration_limit, float)
    time, rows = (np.zeros(0), np.full((1, 1), np.nan)) if broken else _stopped(*_joined(parts), limit)
    if not np.isfinite(rows).all():
        raise ValueError(f"world {index[0]}: found a plan that is not finite, allowed: a world with a plan")
    chain = job.robot.chain
    units = tuple(_UNITS[kind] for kind in chain.kinds)
    position = eased(time, _unwrapped(units, rows[:, : chain.size]))
    pen = rows[:, _PEN] > 0.5
    found = smooth_trajectory(chain.names, units, time, position, pen)
    share = float((np.abs(found.acceleration) / limit).max())  # linear between samples: largest at one
    if share <= 1:
        return found
    return smooth_trajectory(chain.names, units, time * np.sqrt(share), position, pen)


def smooth_trajectory(
    names: tuple[str, ...],
    units: tuple[str, ...],
    time: Float[np.ndarray, " t"],
    position: Float[np.ndarray, "t joints"],
    pen: Bool[np.ndarray, " t"],
) -> JointTrajectory:
    """The twice continuously differentiable cubic spline through the positions, at rest at both ends.

    Velocity and acceleration are its derivatives, so that the three agree with each other. Hinges are
    unwrapped: an angle never jumps by a turn.
    """
    from scipy.interpolate import CubicSpline

    position = _unwrapped(units, position)
    spline = CubicSpline(time, position, bc_type="clamped")
    return JointTrajectory(names, units, time, position, spline(time, 1), spline(time, 2), pen)


def eased(
    time: Float[np.ndarray, " t"], position: Float[np.ndarray, "t joints"]
) -> Float[np.ndarray, "t joints"]:
    """The positions at which a cubic B-spline passes that has these as control points; the ends stay.

    A spline through positions whose acceleration begins at once swings beyond it, by up to a third. At even
    times h the B-spline's acceleration is the second difference over h^2: between samples too it is nowhere
    larger than the mean acceleration about a sample, so that limits which the plan keeps are kept. It is off
    by h^2 / 6 of the acceleration, base and arm alike, so that the brush hardly moves.
    """
    before, after = np.diff(time)[:-1, None], np.diff(time)[1:, None]
    slope = np.diff(position, axis=0) / np.diff(time)[:, None]
    bend = np.diff(slope, axis=0) / (before + after)
    out = position.copy()
    out[1:-1] += before * after / 3 * bend
    return out


def _unwrapped(units: tuple[str, ...], position: np.ndarray) -> np.ndarray:
    turns = np.array([unit == "rad" for unit in units])
    return np.where(turns, np.unwrap(position, axis=0), position)


def _resting(job: Job, plan: JointPlan, wheels: int) -> World:
    """One robot at rest at the end of a plan, odometry right and nothing slipping."""
    last = np.asarray(plan.rows)[:, _rows_of(plan) - 1]
    base, arm = jnp.asarray(last[:, :3]), jnp.asarray(last[:, 3 : job.robot.chain.size])
    return jax.vmap(lambda b, a: standing(b, a, no_slip(wheels, last.dtype), wheels))(base, arm)


def _rows_of(plan: JointPlan, lag: float = 0.0) -> int:
    """How many rows of a plan of one world are lived through: where the plan is no record, also the one in
    which it rests.
    """
    steps, rows = float(plan.duration[0]) / float(plan.step[0]), plan.rows.shape[1]
    if not np.isfinite(steps):
        return rows
    return min(rows, round(steps) if lag else int(np.ceil(steps - 1e-3)) + 1)


def _joined(parts: list[tuple[JointPlan, float]]) -> tuple[np.ndarray, np.ndarray]:
    """Times and rows of plans one after the other; each part with the time of its first row."""
    times, rows, now = [], [], 0.0
    for plan, lag in parts:
        count = _rows_of(plan, lag)
        time = now + lag + np.arange(count) * _seconds(plan.step[0])
        new = slice(1 if times and lag == 0 else 0, None)  # where the part before ended
        times.append(time[new])
        rows.append(np.asarray(plan.rows, float)[0, :count][new])
        now = float(time[-1])
    return np.concatenate(times), np.concatenate(rows)


def _stopped(time: np.ndarray, rows: np.ndarray, limit: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The same with a stop at constant deceleration, pen up, from the velocity of the last two rows."""
    step = time[-1] - time[-2]
    velocity = (rows[-1] - rows[-2]) / step
    stop = max(_STOP, float((np.abs(velocity[: len(limit)]) / (_BRAKING * limit)).max()))
    after = np.linspace(0, stop, max(2, round(stop / step)) + 1)[1:]
    tail = rows[-1] + velocity * (after - after**2 / (2 * stop))[:, None]
    tail[:, _PEN] = 0
    return np.concatenate([time, time[-1] + after]), np.concatenate([rows, tail])


def _seconds(value) -> float:
    """The decimal number that a rounded one stands for: 0.02, not the float32 beside it."""
    return float(str(np.asarray(value)[()]))
