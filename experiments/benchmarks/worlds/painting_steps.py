"""Painting steps of many robots: control, base, odometry and paint, on the product's own program; and the
gradient through them.
"""

from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from experiments.benchmarks.compare import rate
from experiments.benchmarks.worlds.physics_rollouts import groups
from jaxpaint.compiling import batched, one_by_one
from jaxpaint.decisions import default_thresholds
from jaxpaint.kinematics import forward
from opt.plan import Samples
from opt.wbc import RobotLimits, WholeBodyController, default_settings
from sims.backward import Backward
from sims.limits import robot_limits
from sims.noise import noise_preset
from sims.odometry import OdometryNoise, draw_slip
from sims.paint import Brush, Contact, Paint, PaintGrid, contact, deposit, film_at, window_cells
from sims.robots import load_robot
from sims.rollout import RECORD_EVERY, run_block, start
from sims.scenes import flat
from sims.worlds import Fidelity, Kinematic, standing

_DT, _RECORDS = 0.02, 25
STEPS = RECORD_EVERY * _RECORDS
# A circle on the wall [m], drawn at this speed [m/s].
_RADIUS, _SPEED = 0.1, 0.03
# Each step is done again on the way back: what a step leaves for it would not fit the cache.
_BACKWARD = Backward(keep="steps")
# Cells of the paint [m], and points of a circle at which a gradient looks at it.
_CELL, _POINTS = 0.002, 64
# Worlds that a device takes at a time: as fit the cache, the way back with what it keeps of each step.
_CHUNK, _CHUNK_BACK = 256, 64


class Task(NamedTuple):
    """What all worlds share."""

    robot: RobotLimits
    noise: OdometryNoise
    rows: Float[Array, "t 19"]
    home: Float[Array, " a"]
    base: Float[Array, "3"]
    temperature: Float[Array, ""]


class PaintingSteps:
    """So many worlds, each with wheels of its own, that paint a circle for two seconds."""

    def __init__(self, worlds: int, fidelity: Fidelity | None = None, *, clearance: bool = True) -> None:
        robot, self.worlds = load_robot(), worlds
        limits, scene = robot_limits(robot, clearance=clearance), flat()
        brush = forward(limits.chain, robot.at_home(jnp.zeros(3)))
        self._scene, self._height = scene, float(brush.p[2])
        self._grid, self._brush = _canvas(self._height)
        base = jnp.asarray([-float(brush.p[0]), 0.0, 0.0])
        rows = jnp.asarray(_circle(np.asarray(brush.R), float(brush.p[2])), float)
        noise = noise_preset("s1-simulation").odometry
        self._task = Task(limits, noise, rows, robot.home, base, jnp.asarray(0.05))
        self._fidelity = fidelity or Kinematic()
        self._all = np.arange(worlds, dtype=np.int32), np.zeros((worlds, 3), np.float32)
        self.move = batched(self._contacts, in_axes=(None, None, 0, 0), chunk=_CHUNK)
        self.lay = one_by_one(self._score, in_axes=(None, 0))
        self.back = batched(self._value_and_slope, in_axes=(None, None, 0, 0), chunk=_CHUNK_BACK)

    def rate(self, worlds: int | None = None) -> float:
        """Control steps a second, paint included, of the first so many worlds."""
        count = worlds or self.worlds
        return rate(lambda: self.forward(count), count * STEPS)

    def gradient_rate(self) -> float:
        """The same with the gradient of the paint's error to the controller's parameters."""
        return rate(self.gradient, self.worlds * STEPS)

    def forward(self, worlds: int | None = None) -> Float[np.ndarray, " worlds"]:
        """What the paint is off by in each world."""
        parts = groups(self._all, worlds or self.worlds)
        return np.concatenate([self.lay(self._grid, self._moved(*part)) for part in parts])

    def gradient(self) -> tuple[Float[np.ndarray, " worlds"], Float[np.ndarray, "worlds 3"]]:
        """What the film is off by at points of the circle and beside it, and its gradient to logarithms of
        gain, of the arm's effort and of pace.
        """
        common = self._task, self._fidelity
        found = [self.back(*common, *part) for part in groups(self._all, self.worlds)]
        values, slopes = zip(*found, strict=True)
        return np.concatenate(values), np.concatenate(slopes)

    def _moved(self, index, parameters) -> Contact:
        return self.move(self._task, self._fidelity, index, parameters)

    def _contacts(self, task: Task, fidelity: Fidelity, index: Int[Array, ""], parameters) -> Contact:
        key = jax.random.fold_in(jax.random.key(0), index)
        follow = _controller(task, parameters)
        slip = draw_slip(task.noise, task.robot.drive.size, key=key)
        world = standing(task.base, task.home, slip, task.robot.drive.size)
        dt = jnp.asarray(_DT, task.base.dtype)
        begin = start(follow, fidelity, world)
        common = task.robot, task.noise, dt, begin, key
        _, record = run_block(follow, fidelity, *common, records=_RECORDS, backward=_BACKWARD)
        q = jnp.concatenate([record.base, record.arm], axis=-1)
        _, (place, axis) = jax.lax.scan(lambda c, row: (c, _brush(task.robot, row)), None, q)
        period = dt * RECORD_EVERY
        speed = jnp.concatenate([place[1:] - place[:-1], place[-1:] - place[-2:-1]]) / period
        rows = place, axis, speed, jnp.full((_RECORDS,), period), record.pen
        _, found = jax.lax.scan(lambda c, row: (c, contact(self._scene.chart, *row)), None, rows)
        return found

    def _score(self, grid: PaintGrid, contacts: Contact) -> Float[Array, ""]:
        paint = Paint.bare(grid)
        window = window_cells(self._brush, _CELL)
        laid = deposit(paint, self._brush, grid, contacts, window=window).thickness
        far = grid.centres() - jnp.asarray([0.0, self._height + _RADIUS])
        ring = jnp.abs(jnp.sqrt((far**2).sum(-1) + 1e-12) - _RADIUS) < self._brush.radius
        return ((laid / self._brush.film - ring) ** 2).mean()

    def _value_and_slope(self, task: Task, fidelity: Fidelity, index, parameters):
        return jax.value_and_grad(lambda p: self._film_error(self._contacts(task, fidelity, index, p)))(
            parameters
        )

    def _film_error(self, contacts: Contact) -> Float[Array, ""]:
        """What the film is off by on the circle, and on two beside it that should be bare."""
        middle = jnp.asarray([0.0, self._height + _RADIUS])
        angle = 2 * jnp.pi * jnp.arange(_POINTS) / _POINTS
        around = jnp.stack([jnp.sin(angle), jnp.cos(angle)], axis=1)
        radii = _RADIUS + jnp.asarray([0.0, -1.0, 1.0]) * 2 * self._brush.radius
        points = (middle + radii[:, None, None] * around[None]).reshape(-1, 2)
        wanted = jnp.repeat(jnp.asarray([1.0, 0.0, 0.0]), _POINTS)
        return ((film_at(self._brush, contacts, points) / self._brush.film - wanted) ** 2).mean()


def _canvas(height: float) -> tuple[PaintGrid, Brush]:
    """A grid about the circle, whose lowest point is at this height."""
    low, high = np.array([-0.15, height - 0.05]), np.array([0.15, height + 0.25])
    return PaintGrid.covering(low, high, _CELL), Brush(radius=0.01, nominal_speed=_SPEED)


def _brush(robot: RobotLimits, q):
    pose = forward(robot.chain, q)
    return pose.p, pose.R[:, 2]


def _controller(task: Task, parameters: Float[Array, "3"]) -> WholeBodyController:
    """Decisions relaxed by the task's temperature, so that there is a gradient."""
    scale, settings = jnp.exp(parameters), default_settings()
    settings = eqx.tree_at(
        lambda s: (s.position_gain, s.arm_effort, s.qp_smoothing),
        settings,
        (settings.position_gain * scale[0], settings.arm_effort * scale[1], jnp.asarray(1e-4)),
    )
    thresholds = default_thresholds(release_margin=0.05)
    thresholds = eqx.tree_at(
        lambda t: (t.halt_temperature, t.release_temperature),
        thresholds,
        (task.temperature, task.temperature),
    )
    step = jnp.asarray(_DT)
    reference = Samples(task.rows, step, 0 * step)
    stations = Samples(task.base[None], step, 0 * step)
    speed, duration = jnp.asarray(_SPEED), jnp.asarray(10.0)
    return WholeBodyController(
        robot=task.robot,
        settings=settings,
        thresholds=thresholds,
        reference=reference,
        stations=stations,
        speed=speed,
        pace=scale[2],
        duration=duration,
    )


def _circle(rotation: np.ndarray, height: float) -> np.ndarray:
    time = np.arange(STEPS + 2) * _DT
    angle = _SPEED * (time - 0.2 * (1 - np.exp(-time / 0.2))) / _RADIUS
    pace = _SPEED * (1 - np.exp(-time / 0.2))
    zero = 0 * time
    place = np.stack([zero, _RADIUS * np.sin(angle), height + _RADIUS * (1 - np.cos(angle))], axis=1)
    speed = pace[:, None] * np.stack([zero, np.cos(angle), np.sin(angle)], axis=1)
    turned = np.tile(rotation.reshape(-1), (len(time), 1))
    return np.concatenate([place, turned, speed, np.zeros((len(time), 3)), np.ones((len(time), 1))], axis=1)
