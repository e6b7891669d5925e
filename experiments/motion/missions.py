"""Random missions before a wall: brush poses with approach and retreat, and camera poses."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float

from experiments.motion.truth import Truth
from jaxpaint.compiling import batched, one_by_one
from jaxpaint.kinematics import Pose, compose, exponential, frame_from_axis, solve, spread_starts
from jaxpaint.trajectories import Trajectory
from sims.limits import robot_limits
from sims.painting.motion import motion_among
from sims.painting.segments import Around, body_gap, surroundings
from sims.painting.survey import camera_arm, echoes_before
from sims.robots import load_robot
from sims.scenes import Scene, default_canvas, make_wall

TARGETS, _TRIES = 4, 10
# Brush above the wall before and after a touch [m]; the camera's distance [m].
_LIFT, _VIEW = 0.05, (0.5, 0.75)
# The body of a posture is at least so far from everything, by truth and by what the robot knows [m].
_ROOM = 0.02
# How much further from the canvas than the arm at home reaches a mission starts and ends [m].
_BACK = 0.3
_GRID = 0.07  # of the scanned points [m]


@dataclasses.dataclass(frozen=True, eq=False)
class Missions:
    """scene, around: the wall, and what planning is told. waypoints: in the map frame. points: scanned [m].
    trajectory, gap: as planned.
    """

    scene: Scene
    around: Around
    waypoints: Float[np.ndarray, "missions w joints"]
    points: Float[np.ndarray, "m 3"]
    trajectory: Trajectory
    gap: Float[np.ndarray, " missions"]


def random_missions(wall: str, count: int, *, seed: int = 0) -> Missions:
    """Plans `count` missions before a wall of that kind: from a start through `TARGETS` targets, back home.

    A brush target is three waypoints: before the wall, at it, before it again; a camera target one.
    """
    scene, robot = make_wall(wall), load_robot()
    canvas, key = default_canvas(scene), jax.random.key(seed)
    echoes = echoes_before(scene, canvas, camera_arm(robot), robot, key=key)
    around = Around(robot, canvas, jnp.asarray(echoes, jnp.float32))
    rng = np.random.default_rng([seed, *wall.encode()])
    points = _scanned(scene, rng)
    postures, fine = _postures(scene, around, points, rng, count * TARGETS)
    postures = _first_fine(postures, fine).reshape(count, TARGETS * 3, -1)
    home = np.repeat(np.asarray(robot.home)[None], count, 0)
    start, back = (np.concatenate([_starts(around, rng, count), home], -1)[:, None] for _ in range(2))
    rows = np.concatenate([start, postures, back], 1)
    waypoints = jnp.asarray(rows, jnp.float32)
    seen = np.broadcast_to(points.astype(np.float32), (count, *points.shape))
    motion = motion_among(around, waypoints, seen)
    return Missions(scene, around, np.asarray(waypoints), points, motion.trajectory, np.asarray(motion.gap))


def _starts(around: Around, rng, count: int) -> np.ndarray:
    """Bases (x, y, yaw) before the middle of the canvas, further back than the arm at home reaches."""
    yaw = float(around.canvas.yaw)
    ahead, left = np.array([np.cos(yaw), np.sin(yaw)]), np.array([-np.sin(yaw), np.cos(yaw)])
    away = float(robot_limits(around.robot).home[0]) + _BACK + rng.uniform(0, 0.3, count)
    aside = rng.uniform(-0.3, 0.3, count)
    place = np.asarray(around.canvas.center)[:2] - away[:, None] * ahead + aside[:, None] * left
    return np.concatenate([place, yaw + rng.uniform(-0.3, 0.3, (count, 1))], -1)


def _scanned(scene: Scene, rng) -> np.ndarray:
    """Noisy points of the wall about the canvas, as far apart as those of a cloud that was made sparse."""
    chart = scene.chart
    u, v = np.meshgrid(np.arange(-1.4, 1.4, _GRID), np.arange(0.3, 2.2, _GRID))
    uv = jnp.asarray(np.stack([u.ravel(), v.ravel()], -1), jnp.float32)
    return np.asarray(jax.vmap(chart.point)(uv)) + 0.002 * rng.standard_normal((u.size, 3))


def _postures(scene: Scene, around: Around, points, rng, number: int):
    """Tries of postures [number, tries, 3, joints] and whether each can be taken."""
    shape = (number * _TRIES,)
    uv = jnp.asarray(
        np.stack([rng.uniform(-0.75, 0.75, shape), rng.uniform(0.85, 1.5, shape)], -1), jnp.float32
    )
    chart = scene.chart
    draw = {
        "point": jax.vmap(chart.point)(uv),
        "normal": jax.vmap(chart.normal)(uv),
        "camera": jnp.asarray(np.repeat(rng.random(number) < 0.4, _TRIES)),
        "view": jnp.asarray(rng.uniform(*_VIEW, shape), jnp.float32),
        "tilt": jnp.asarray(rng.normal(0, 0.08, (*shape, 3)), jnp.float32),
        "base": jnp.asarray(rng.normal(0, [0.08, 0.12, 0.15], (*shape, 3)), jnp.float32),
    }
    found, converged = _SOLVE(around, robot_limits(around.robot).home, draw)
    gap = _POSTURE_GAP(around, found, jnp.asarray(points, jnp.float32))
    found, fine = np.asarray(found), np.asarray(converged) & (np.asarray(gap) > _ROOM)
    # what truly stands in the wall is no fair mission, whatever the planner believes
    before_and_at = found[fine, :2].reshape(-1, found.shape[2])
    fine[fine] = Truth(scene, around.robot).distances(before_and_at).reshape(-1, 2).min(1) > _ROOM
    return found.reshape(number, _TRIES, 3, -1), fine.reshape(number, _TRIES)


def _first_fine(postures, fine: Bool[np.ndarray, "n tries"]):
    """The first try that is fine; where none is, that of a target before."""
    rows, last = [], postures[np.flatnonzero(fine.any(1))[0]][fine[fine.any(1)][0].argmax()]
    for tries, ok in zip(postures, fine, strict=True):
        last = tries[ok.argmax()] if ok.any() else last
        rows.append(last)
    return np.stack(rows)


def _solve_one(around: Around, home, draw):
    """Joint positions [3, joints] of one target, before, at and after the touch."""
    robot, point, normal = around.robot, draw["point"], draw["normal"]
    yaw = jnp.arctan2(-normal[1], -normal[0]) + draw["base"][2]
    c, s = jnp.cos(yaw), jnp.sin(yaw)
    x, y = home[0] + draw["base"][0], home[1] + draw["base"][1]
    base = jnp.stack([point[0] - c * x + s * y, point[1] - s * x - c * y, yaw])
    R = compose(exponential(draw["tilt"]), frame_from_axis(-normal, around.canvas.u_axis))
    held = Pose(point - jnp.where(draw["camera"], draw["view"], _LIFT) * R[:, 2], R)
    seen = held @ robot.T_brush_camera.inverse()
    target = jax.tree.map(lambda a, b: jnp.where(draw["camera"], a, b), seen, held)
    spread = spread_starts(robot.home, robot.lower, robot.upper, count=6)
    arm = robot.arm(base)
    first = solve(arm, spread, target, robot.lower, robot.upper)
    touching = Pose(jnp.where(draw["camera"], target.p, point), target.R)
    touch = solve(arm, first.q[None], touching, robot.lower, robot.upper)
    there = jnp.where(draw["camera"], first.q, touch.q)
    rows = jnp.stack([jnp.concatenate([base, q]) for q in (first.q, there, first.q)])
    return rows, first.converged & touch.converged


def _posture_gap(around: Around, rows, points):
    there = surroundings(around, points)
    return jax.lax.map(lambda q: body_gap(around.robot, there, q[None]), rows[:2]).min()


_SOLVE = batched(_solve_one, in_axes=(None, None, 0))
_POSTURE_GAP = one_by_one(_posture_gap, in_axes=(None, 0, None))
