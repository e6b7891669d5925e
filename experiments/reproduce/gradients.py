"""Gradients through rollouts of `kinematic` and `dynamic`: how right they are against the horizon, and what
they cost in time and memory.
"""

import statistics
import time

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int
from matplotlib.figure import Figure

from experiments.report.style import look
from experiments.reproduce.result import ReproduceResult, ReproduceSettings, Row
from jaxpaint.compiling import Batched, batched
from jaxpaint.kinematics import forward
from opt.controller import Command
from opt.wbc import RobotLimits
from sims.backward import Backward
from sims.dynamics import dynamic
from sims.limits import robot_limits
from sims.noise import noise_preset
from sims.odometry import OdometryNoise, no_slip
from sims.robots import load_robot, robot_model
from sims.rollout import RECORD_EVERY
from sims.worlds import Fidelity, Kinematic, standing

NAME = "gradients"
HORIZONS = (1, 5, 20, 50, 100, 200, 400)
"""Control steps."""
POINTS = 4
_DT, _SIZE = 0.02, 9
# Steps of the differences: where rounding and curvature are both small, and as large as an optimiser's.
_FINE, _COARSE = 1e-5, 1e-2
# What cost is measured with.
_WORLDS, _STEPS, _ROUNDS = 64, 100, 3


def run(settings: ReproduceSettings | None = None) -> ReproduceResult:
    """Rows: relative error against central differences in float64, fine and coarse, by horizon; then the
    seconds and the memory of a gradient through 100 control steps in 64 worlds, by what is kept.
    """
    seed, rows, errors = (settings or ReproduceSettings()).seed, [], {}
    for name, fidelity in {"kinematic": Kinematic(), "dynamic": dynamic(robot_model())}.items():
        with jax.enable_x64(True):
            errors[name] = _errors(_doubles(fidelity), seed)
        for horizon, (fine, coarse) in errors[name].items():
            rows.append(Row(f"relative error, {horizon} steps [1]", name, None, fine))
            rows.append(Row(f"relative error of steps of 1 %, {horizon} steps [1]", name, None, coarse))
        rows += _costs(name, fidelity)
    return ReproduceResult.of(rows, {"horizon": _figure(errors)})


def _loss(
    fidelity: Fidelity,
    robot: RobotLimits,
    noise: OdometryNoise,
    home: Float[Array, " a"],
    steps: Int[Array, " t"],
    horizon: Int[Array, ""],
    told: Float[Array, "9"],
    backward: Backward,
) -> Float[Array, ""]:
    """Squared way of the brush [dm^2] in so many control steps of a base that is told a twist, and of an arm
    that is told to swing.
    """
    dt = jnp.asarray(_DT, told.dtype)
    world = fidelity.begin(standing(jnp.zeros(3, told.dtype), home, no_slip(robot.drive.size, told.dtype), 4))
    first = forward(robot.chain, jnp.concatenate([world.base, world.arm])).p

    def step(world, number):
        swing = jnp.cos(0.5 * number * dt)
        command = Command(told[:3], told[:3], told[3:] * swing)
        after = fidelity.step(robot, noise, world, command, jnp.zeros_like(world.base), dt)
        return jax.tree.map(lambda a, b: jnp.where(number < horizon, a, b), after, world), None

    def record(world, numbers):
        world = backward.cut(world, numbers[0] // RECORD_EVERY)
        return jax.lax.scan(backward.step(step), world, numbers)

    world, _ = jax.lax.scan(backward.record(record), world, steps.reshape(-1, RECORD_EVERY))
    last = forward(robot.chain, jnp.concatenate([world.base, world.arm])).p
    return 100 * ((last - first) ** 2).sum()


def _programs(backward: Backward) -> tuple[Batched, Batched]:
    """The loss, and the loss with its gradient to what is told."""

    def value(fidelity, robot, noise, home, steps, horizon, told):
        return _loss(fidelity, robot, noise, home, steps, horizon, told, backward)

    def both(*given):
        return jax.value_and_grad(value, argnums=6)(*given)

    axes = (None, None, None, None, None, 0, 0)
    return batched(value, in_axes=axes, chunk=_WORLDS // 2), batched(both, in_axes=axes, chunk=_WORLDS // 2)


def _shared(fidelity: Fidelity, steps: int, double: bool):
    robot = load_robot()
    shared = fidelity, robot_limits(robot, clearance=False), noise_preset("none").odometry, robot.home
    return *(_doubles(shared) if double else shared), jnp.arange(steps)


def _points(count: int, seed: int) -> np.ndarray:
    """Twists of centimetres a second, joints of tenths of a radian a second."""
    most = np.array([0.05, 0.05, 0.1, *[0.1] * 6])
    return np.random.default_rng(seed).uniform(0.3, 1.0, (count, _SIZE)) * most


def _errors(fidelity: Fidelity, seed: int) -> dict[int, tuple[float, float]]:
    """Median over points of |gradient - difference| / |difference|, of both steps, by horizon."""
    shared = _shared(fidelity, max(HORIZONS), double=True)
    value, both = _programs(Backward(keep="steps"))
    points = np.tile(_points(POINTS, seed), (len(HORIZONS), 1))
    horizon = np.repeat(HORIZONS, POINTS)
    slope = np.asarray(both(*shared, horizon, points)[1])
    found = [_off(value, shared, horizon, points, slope, share) for share in (_FINE, _COARSE)]
    return {h: tuple(float(np.median(x[horizon == h])) for x in found) for h in HORIZONS}  # type: ignore[misc]


def _off(value: Batched, shared, horizon, points, slope, share: float) -> Float[np.ndarray, " n"]:
    """share: of each number, by which it is moved either way."""
    step = share * points[:, None] * np.eye(_SIZE)
    moved = np.concatenate([points[:, None] + step, points[:, None] - step], axis=1).reshape(-1, _SIZE)
    values = np.asarray(value(*shared, np.repeat(horizon, 2 * _SIZE), moved)).reshape(-1, 2, _SIZE)
    difference = (values[:, 0] - values[:, 1]) / (2 * share * points)
    return np.linalg.norm(slope - difference, axis=1) / np.linalg.norm(difference, axis=1)


def _costs(name: str, fidelity: Fidelity) -> list[Row]:
    shared = _shared(fidelity, _STEPS, double=False)
    points = _points(_WORLDS, 0).astype(np.float32)
    horizon, rows = np.full(_WORLDS, _STEPS), []
    for keep in ("all", "steps", "records"):
        value, both = _programs(Backward(keep=keep))
        seconds = _seconds(both, shared, horizon, points)
        ratio = seconds / _seconds(value, shared, horizon, points)
        variant = f"{name}, keep {keep}"
        rows += [
            Row("gradient through 100 steps, 64 worlds [s]", variant, None, seconds),
            Row("the same over the value alone [1]", variant, None, ratio),
            Row("its memory [MB]", variant, None, both.temporary_bytes() / 1e6),
            Row("to compile [s]", variant, None, both.compile_s),
        ]
    return rows


def _seconds(run: Batched, shared, horizon, points) -> float:
    times = []
    for _ in range(_ROUNDS + 1):
        begin = time.perf_counter()
        jax.block_until_ready(run(*shared, horizon, points))
        times.append(time.perf_counter() - begin)
    return statistics.median(times[1:])


def _doubles(tree):
    def double(x):
        floating = eqx.is_array(x) and jnp.issubdtype(x.dtype, jnp.floating)
        return jnp.asarray(x, jnp.float64) if floating else x

    return jax.tree.map(double, tree)


def _figure(errors: dict[str, dict[int, tuple[float, float]]]) -> Figure:
    with look():
        figure = Figure(figsize=(6.4, 4.2), layout="constrained")
        axes = figure.subplots()
        for name, found in errors.items():
            for k, what in enumerate(("rounding", "steps of 1 %")):
                axes.plot(list(found), [x[k] for x in found.values()], marker="o", label=f"{name}, {what}")
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_xlabel("horizon [control steps]")
        axes.set_ylabel("relative error of the gradient")
        axes.legend()
        return figure
