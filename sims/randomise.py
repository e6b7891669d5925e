"""Worlds that differ: masses, friction, servos, calibration, latency, noise and the slope of the floor.

Drawn by the world's own key. Only what changes is kept for each world; ranges are traced.
"""

import dataclasses
from collections.abc import Callable
from typing import Self

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int, PRNGKeyArray

from jaxpaint.compiling import PerWorld, batched
from sims.delay import Delayed, inner_fidelity
from sims.painting.job import RANDOMISED, Job
from sims.parameters import scalar
from sims.truth import Calibration

# A floor of oil on ice [-].
_LEAST_FRICTION = 0.05


class Ranges(eqx.Module):
    """How far worlds differ; every draw is uniform. Shares are of the nominal value, either way.

    mass, servo_gain: share, each link and joint its own. friction: lowest and highest, of the floor [-].
    joint_offset [rad], camera_position [m], camera_rotation [rad]: either way, each axis its own. latency:
    from 0 up to this [s]. depth_noise, lidar_noise: share. slope: of the floor, any direction, from 0 up to
    this [rad]. The defaults are a workshop's: arms are calibrated to tenths of a millimetre at half a metre,
    cameras mounted by hand, floors even to 5 mm on a metre.
    """

    mass: Float[Array, ""] = eqx.field(converter=scalar, default=0.05)
    servo_gain: Float[Array, ""] = eqx.field(converter=scalar, default=0.2)
    friction: Float[Array, "2"] = eqx.field(converter=jnp.asarray, default=(0.5, 1.0))
    joint_offset: Float[Array, ""] = eqx.field(converter=scalar, default=5e-4)
    camera_position: Float[Array, ""] = eqx.field(converter=scalar, default=1e-3)
    camera_rotation: Float[Array, ""] = eqx.field(converter=scalar, default=5e-3)
    latency: Float[Array, ""] = eqx.field(converter=scalar, default=0.02)
    depth_noise: Float[Array, ""] = eqx.field(converter=scalar, default=0.3)
    lidar_noise: Float[Array, ""] = eqx.field(converter=scalar, default=0.3)
    slope: Float[Array, ""] = eqx.field(converter=scalar, default=5e-3)

    def scaled(self, factor: float, friction: float) -> Self:
        """All ranges wider, or narrower, about their middles; friction's about the one given."""
        low, high = np.asarray(self.friction)
        half = factor * (high - low) / 2
        ranges = jax.tree.map(lambda x: factor * x, self)
        between = jnp.asarray([max(friction - half, _LEAST_FRICTION), friction + half])
        return eqx.tree_at(lambda r: r.friction, ranges, between)


def randomised(job: Job, ranges: Ranges, index: np.ndarray) -> Job:
    """The job with everything drawn for the worlds of these indices, marked by `PerWorld`.

    What a fidelity does not have (masses in `kinematic`, friction in `dynamic`) is left out.
    """
    latency = job.fidelity.latency if isinstance(job.fidelity, Delayed) else jnp.zeros_like(job.dt)
    inner, physics = inner_fidelity(job.fidelity), _physics(job)
    if physics is not None:  # the arm balances the weight that it should have
        inner = dataclasses.replace(inner, known=physics)  # type: ignore[call-arg]
    job = dataclasses.replace(job, fidelity=Delayed(inner, latency))
    drawn = _DRAW(job, ranges, jnp.asarray(index, jnp.int32))
    return eqx.tree_at(_changing(job), job, [PerWorld(x) for x in drawn])


def _changing(job: Job) -> Callable[[Job], list]:
    """Where in the job what differs is: calibration, latency, noise, and what of physics its fidelity has."""
    names = [name for name in _PHYSICS if hasattr(_physics(job), name)]

    def where(j: Job) -> list:
        noise = j.noise.depth.disparity_sigma, j.sight.scanner.sigma
        return [j.calibration, _latency(j), *noise, *(getattr(_physics(j), name) for name in names)]

    return where


def _draw(job: Job, ranges: Ranges, index: Int[Array, ""]) -> list:
    """One world's values of what `_changing` names, in its order."""
    key = job.key(index, RANDOMISED)
    draws = _Draws(key, job.dt.dtype)
    calibration = Calibration(
        draws.either(ranges.joint_offset, job.robot.home.shape),
        draws.either(ranges.camera_position, (3,)),
        draws.either(ranges.camera_rotation, (3,)),
    )
    latency = draws.between(jnp.zeros_like(ranges.latency), ranges.latency)
    depth = job.noise.depth.disparity_sigma * (1 + draws.either(ranges.depth_noise))
    lidar = job.sight.scanner.sigma * (1 + draws.either(ranges.lidar_noise))
    physics = _physics(job)
    varied = [draw(draws, ranges, getattr(physics, n)) for n, draw in _PHYSICS.items() if hasattr(physics, n)]
    return [calibration, latency, depth, lidar, *varied]


class _Draws:
    """Uniform numbers, each from a key of its own by its place in the order of draws."""

    def __init__(self, key: PRNGKeyArray, dtype):
        self._key, self._dtype, self._count = key, dtype, 0

    def between(self, low, high, shape: tuple[int, ...] = ()) -> Array:
        self._count += 1
        u = jax.random.uniform(jax.random.fold_in(self._key, self._count), shape, self._dtype)
        return low + (high - low) * u

    def either(self, most, shape: tuple[int, ...] = ()) -> Array:
        return self.between(-most, most, shape)


def _shares(name: str) -> Callable:
    """Each entry changed by its own share."""

    def draw(draws: _Draws, ranges: Ranges, nominal: Array) -> Array:
        return nominal * (1 + draws.either(getattr(ranges, name), nominal.shape))

    return draw


def _friction(draws: _Draws, ranges: Ranges, nominal: Array) -> Array:
    return draws.between(ranges.friction[0], ranges.friction[1], nominal.shape)


def _leaning(draws: _Draws, ranges: Ranges, nominal: Array) -> Array:
    """Gravity on a floor that slopes, in the floor's frame."""
    slope = draws.between(jnp.zeros_like(ranges.slope), ranges.slope)
    way = draws.either(jnp.asarray(jnp.pi, slope.dtype))
    aside, down = jnp.sin(slope) * nominal[2], jnp.cos(slope) * nominal[2]
    return jnp.stack([aside * jnp.cos(way), aside * jnp.sin(way), down])


_PHYSICS = {
    "mass": _shares("mass"),
    "velocity_gain": _shares("servo_gain"),
    "position_gain": _shares("servo_gain"),
    "gravity": _leaning,
    "friction": _friction,
}


def _physics(job: Job):
    """The physical parameters of its fidelity; `kinematic` has none."""
    return getattr(inner_fidelity(job.fidelity), "physics", None)


def _latency(job: Job):
    assert isinstance(job.fidelity, Delayed)
    return job.fidelity.latency


_DRAW = batched(_draw, in_axes=(None, None, 0))
