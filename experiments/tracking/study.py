"""A robot before a wall with a curve to follow, planned without scan: the curve lies on the true surface."""

import dataclasses
import functools

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from experiments.commands.paint_options import PaintOptions
from experiments.paint_job import paint_task
from experiments.tracking.curves import Curve
from jaxpaint.kinematics.rotations import frame_from_axis
from sims.painting.drive import BrushPlan
from sims.painting.job import Job
from sims.painting.path import STATION_EVERY, stations

# Width and height [m].
_CANVAS = (2.4, 0.6)
# Along the curve [m/s^2], at its ends.
_ACCELERATION = 0.3
# Points of the wall that the base is kept clear of, each way.
_GRID = 24
_STATIONS = jax.jit(stations)
# Rows of plans are padded to a multiple of this, so that few lengths are ever compiled.
_ROWS = 500


@dataclasses.dataclass(frozen=True)
class Study:
    """job: of the curve's wall and presets. plan: of one world, without a worlds axis. length: [m]."""

    job: Job
    plan: BrushPlan
    length: float


def study_of(
    curve: Curve,
    *,
    wall: str = "room",
    noise: str = "s1-simulation",
    fidelity: str = "kinematic",
    speed: float = 0.03,
    seed: int = 0,
) -> Study:
    """The study of a curve in the middle of a wall's canvas, followed at this speed [m/s], pen down."""
    job = _job(wall, noise, fidelity, speed, seed)
    rows, length = _rows(job, curve, speed)
    places = places_for(job, rows)
    step = np.asarray(float(job.dt), rows.dtype)
    duration = np.asarray(_duration(length, speed), rows.dtype)
    plan = BrushPlan(rows, step, 0 * step, places, step * STATION_EVERY, 0 * step, duration)
    return Study(job, plan, length)


def places_for(job: Job, rows: Float[np.ndarray, "t 19"]) -> Float[np.ndarray, "s 3"]:
    """Where the base stands for the rows of a plan, every `STATION_EVERY` control steps."""
    return np.asarray(_STATIONS(job, jnp.asarray(rows), _wall_points(job)))


@functools.cache
def _job(wall: str, noise: str, fidelity: str, speed: float, seed: int) -> Job:
    """A painting job on a canvas that all curves fit on; its picture is not painted."""
    options = PaintOptions(
        wall=wall, noise=noise, fidelity=fidelity, speed=speed, seed=seed, canvas_size=_CANVAS
    )
    return paint_task(options).job


def _duration(length: float, speed: float) -> float:
    return length / speed + speed / _ACCELERATION


def padded_count(duration: float, dt: float) -> int:
    """Rows of a plan that takes so long [s]."""
    return _ROWS * -(-int(np.ceil(duration / dt) + 2) // _ROWS)


def _rows(job: Job, curve: Curve, speed: float) -> tuple[Float[np.ndarray, "t 19"], float]:
    """Rows of `opt.wbc.Reference` at the control period, and the curve's length on the surface [m]."""
    middle, _ = job.scene.chart.to_uv(job.canvas.center)
    uv = jnp.asarray(curve, middle.dtype) + middle
    place = np.asarray(jax.vmap(job.scene.chart.point)(uv), float)
    normal = np.asarray(jax.vmap(job.scene.chart.normal)(uv), float)
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(place, axis=0), axis=1))])
    dt = float(job.dt)
    count = padded_count(_duration(along[-1], speed), dt)
    way = _way(dt * np.arange(count), along[-1], speed)
    position = np.stack([np.interp(way, along, place[:, k]) for k in range(3)], axis=1)
    towards = -np.stack([np.interp(way, along, normal[:, k]) for k in range(3)], axis=1)
    towards /= np.linalg.norm(towards, axis=1, keepdims=True)
    turned = jax.vmap(frame_from_axis, in_axes=(0, None))
    rotation = np.asarray(turned(jnp.asarray(towards, middle.dtype), job.canvas.u_axis), float)
    velocity = np.gradient(position, dt, axis=0)
    spin = _angular_velocity(rotation, dt)
    pen = np.ones((count, 1))
    rows = np.concatenate([position, rotation.reshape(count, 9), velocity, spin, pen], axis=1)
    return rows.astype(np.asarray(job.dt).dtype), float(along[-1])


def _way(time: Float[np.ndarray, " t"], length: float, speed: float) -> Float[np.ndarray, " t"]:
    """Way along a line from rest to rest."""
    ramp = speed / _ACCELERATION
    left = np.clip(_duration(length, speed) - time, 0, None)
    begun = np.where(time < ramp, _ACCELERATION * time**2 / 2, speed * (time - ramp / 2))
    ended = length - np.where(left < ramp, _ACCELERATION * left**2 / 2, speed * (left - ramp / 2))
    return np.where(time < left, begun, ended)


def _angular_velocity(rotation: Float[np.ndarray, "t 3 3"], dt: float) -> Float[np.ndarray, "t 3"]:
    """In the map frame, from neighbouring rotations."""
    change = np.gradient(rotation, dt, axis=0) @ np.swapaxes(rotation, 1, 2)
    return np.stack([change[:, 2, 1], change[:, 0, 2], change[:, 1, 0]], axis=1)


def _wall_points(job: Job) -> Float[Array, "m 3"]:
    """Points of the surface about the canvas."""
    middle, _ = job.scene.chart.to_uv(job.canvas.center)
    u, v = (np.linspace(-s / 2 - 0.1, s / 2 + 0.1, _GRID) for s in _CANVAS)
    uv = np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)
    return jax.vmap(job.scene.chart.point)(jnp.asarray(uv, middle.dtype) + middle)
