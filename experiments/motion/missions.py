"""Random missions before a wall: camera poses, then brush poses with approach and retreat, then back."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float

from experiments.motion.truth import BRUSH, ITSELF, Truth
from jaxpaint.compiling import batched
from jaxpaint.kinematics import Pose, compose, exponential, frame_from_axis, solve, spread_starts
from sims.limits import robot_limits
from sims.painting.motion import Motion, motion_among
from sims.painting.postures import solve_apart
from sims.painting.segments import Around
from sims.painting.survey import camera_arm, echoes_before
from sims.robots import load_robot
from sims.scenes import Scene, default_canvas, make_wall
from sims.sensors import crop_to_canvas

TARGETS = 4
# Tries of a target at a time, and how often so many are drawn before it is given up.
_TRIES, _ROUNDS = 10, 20
# Brush above the wall before and after a touch [m]; the camera's distance [m]; the share of camera targets.
_LIFT, _VIEW, _CAMERAS = 0.05, (0.5, 0.75), 0.4
# A posture is truly at least so far from all that is around it, and does not touch itself [m].
_ROOM = 0.02
# How much further from the canvas than the arm at home reaches a mission starts and ends [m].
_BACK = 0.3
_GRID, _NOISE = 0.07, 0.002  # of the scanned points [m]


@dataclasses.dataclass(frozen=True, eq=False)
class Missions:
    """scene, around: the wall, and what planning is told. waypoints: in the map frame. touches: where the
    brush is at the wall. points: scanned on the way [m]. motion: as planned. redrawn: share of the drawn
    targets that were no fair ones.
    """

    scene: Scene
    around: Around
    waypoints: Float[np.ndarray, "missions w joints"]
    touches: Bool[np.ndarray, "missions w"]
    points: Float[np.ndarray, "m 3"]
    motion: Motion
    redrawn: float

    @property
    def refused(self) -> Bool[np.ndarray, " missions"]:
        """Those that the planner knows no clear way for: they are not driven."""
        return ~self.motion.can_be_driven


def random_missions(wall: str, count: int, *, seed: int = 0) -> Missions:
    """Plans `count` missions before a wall of that kind: from a start through `TARGETS` targets, back home.

    A brush target is three waypoints: before the wall, at it, before it again; a camera target is the same
    posture three times. Camera targets come first, and until the last of them nothing is scanned, as in a
    run: the planner has the lidar's echoes alone. What a target must be is told by the truth alone:
    reachable, and clear of all that is around it by `_ROOM`.
    """
    scene, robot = make_wall(wall), load_robot()
    canvas, key = default_canvas(scene), jax.random.key(seed)
    echoes = echoes_before(scene, canvas, camera_arm(robot), robot, key=key)
    around = Around(robot, canvas, jnp.asarray(echoes, jnp.float32))
    rng, truth = np.random.default_rng([seed, *wall.encode()]), Truth(scene, robot)
    points = _scanned(scene, around, rng).astype(np.float32)
    cameras = np.sort(rng.random((count, TARGETS)) < _CAMERAS, axis=1)[:, ::-1]
    targets, share = _postures(scene, around, truth, rng, cameras.reshape(-1))
    start, back = (_starts(around, truth, rng, count)[:, None] for _ in range(2))
    rows = np.concatenate([start, targets.reshape(count, TARGETS * 3, -1), back], 1).astype(np.float32)
    touches = np.zeros(rows.shape[:2], bool)
    touches[:, 2:-1:3] = ~cameras
    # from the last camera pose on, the cloud is known
    unknown = np.arange(rows.shape[1] - 1) < 3 * cameras.sum(1)[:, None]
    known = np.where(unknown[..., None, None], np.float32(np.nan), points)
    motion = motion_among(around, rows, known, touches)
    return Missions(scene, around, rows, touches, points, motion, share)


def _starts(around: Around, truth: Truth, rng, count: int) -> np.ndarray:
    """At home before the middle of the canvas, with the base further back than the arm at home reaches."""
    yaw, home = float(around.canvas.yaw), np.asarray(around.robot.home)
    ahead, left = np.array([np.cos(yaw), np.sin(yaw)]), np.array([-np.sin(yaw), np.cos(yaw)])
    away = float(robot_limits(around.robot).home[0]) + _BACK + rng.uniform(0, 0.3, count)
    aside = rng.uniform(-0.3, 0.3, count)
    place = np.asarray(around.canvas.center)[:2] - away[:, None] * ahead + aside[:, None] * left
    turn = yaw + rng.uniform(-0.3, 0.3, (count, 1))
    rows = np.concatenate([place, turn, np.repeat(home[None], count, 0)], -1)
    if min(truth.posture(row).distance.min() for row in rows) <= 0:
        raise RuntimeError(f"a mission before the {truth.name} wall starts where something stands")
    return rows


def _scanned(scene: Scene, around: Around, rng) -> np.ndarray:
    """Noisy points of what stands behind the canvas, about as many as planning is told of a cloud."""
    canvas = around.canvas
    width, height = (float(x) / 2 + 0.1 for x in canvas.size)
    u, v = np.meshgrid(np.arange(-width, width, _GRID), np.arange(-height, height, _GRID))
    origin = canvas.center + u.reshape(-1, 1) * canvas.u_axis + v.reshape(-1, 1) * canvas.v_axis
    hit = jax.jit(jax.vmap(scene.raycast, in_axes=(0, None)))(jnp.asarray(origin, jnp.float32), canvas.ray)
    points = np.asarray(origin + hit.distance[:, None] * canvas.ray)
    kept = np.asarray(crop_to_canvas(jnp.asarray(points), hit.valid, canvas))
    return np.where(kept[:, None], points + _NOISE * rng.standard_normal(points.shape), np.nan)


def _postures(scene: Scene, around: Around, truth: Truth, rng, camera: Bool[np.ndarray, " n"]):
    """A target [n, 3, joints] of each kind, and the share of the tries that were not fair.

    Raises RuntimeError where none was found.
    """
    found, missing = np.full((camera.size, 3, around.robot.chain.size), np.nan), np.ones(camera.size, bool)
    tried = refused = 0
    for _ in range(_ROUNDS):
        # as many always: one program
        tries, converged = _SOLVE(around, robot_limits(around.robot).home, _draw(scene, rng, camera))
        tries = np.asarray(tries).reshape(camera.size, _TRIES, *found.shape[1:])
        fine = np.asarray(converged).reshape(camera.size, _TRIES)
        for n in np.flatnonzero(missing):
            for one in tries[n][fine[n]]:
                tried += 1
                if _is_fair(truth, one, touches=not camera[n]):
                    found[n], missing[n] = one, False
                    break
                refused += 1
        if not missing.any():
            return found, refused / tried
    raise RuntimeError(f"{missing.sum()} targets before the {scene.name} wall: none in {_ROUNDS} rounds")


def _is_fair(truth: Truth, rows: Float[np.ndarray, "3 joints"], *, touches: bool) -> bool:
    """Whether what stands there is clear, the brush at its touch apart."""
    before, at = (truth.posture(row).distance for row in rows[:2])
    room = np.where(np.arange(3) == ITSELF, 0, _ROOM)
    counts = np.arange(3) != BRUSH if touches else np.ones(3, bool)
    return bool((before > room).all() and (at > room)[counts].all())


def _draw(scene: Scene, rng, camera: Bool[np.ndarray, " n"]) -> dict:
    """Random numbers of `_TRIES` tries of each target."""
    shape = (camera.size * _TRIES,)
    uv = np.stack([rng.uniform(-0.75, 0.75, shape), rng.uniform(0.85, 1.5, shape)], -1)
    uv = jnp.asarray(uv, jnp.float32)
    return {
        "point": jax.vmap(scene.chart.point)(uv),
        "normal": jax.vmap(scene.chart.normal)(uv),
        "camera": jnp.asarray(np.repeat(camera, _TRIES)),
        "view": jnp.asarray(rng.uniform(*_VIEW, shape), jnp.float32),
        "tilt": jnp.asarray(rng.normal(0, 0.08, (*shape, 3)), jnp.float32),
        "base": jnp.asarray(rng.normal(0, [0.08, 0.12, 0.15], (*shape, 3)), jnp.float32),
    }


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
    first = solve_apart(robot, arm, base, spread, target)
    touching = Pose(jnp.where(draw["camera"], target.p, point), target.R)
    touch = solve(arm, first.q[None], touching, robot.lower, robot.upper)
    there = jnp.where(draw["camera"], first.q, touch.q)
    rows = jnp.stack([jnp.concatenate([base, q]) for q in (first.q, there, first.q)])
    return rows, first.converged & touch.converged


_SOLVE = batched(_solve_one, in_axes=(None, None, 0))
