"""Gradients through a rollout: reverse mode against central differences in float64."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from jaxpaint.compiling import batched
from jaxpaint.decisions import default_thresholds
from jaxpaint.kinematics import forward
from opt.plan import Samples
from opt.wbc import WholeBodyController, default_settings
from sims.limits import robot_limits
from sims.noise import noise_preset
from sims.odometry import Slip
from sims.robots import load_robot
from sims.rollout import run_block, start
from sims.worlds import Kinematic, standing

POINTS = 20
RECORDS = 13  # 52 control steps
DT = 0.02


def doubles(tree):
    return jax.tree.map(
        lambda x: jnp.asarray(x, jnp.float64) if jnp.issubdtype(x.dtype, jnp.floating) else x, tree
    )


def circle(brush, steps):
    """Rows of the reference: a circle on a wall, at 30 mm/s after a smooth start."""
    time = np.arange(steps) * DT
    way = 0.03 * (time - 0.2 * (1 - np.exp(-time / 0.2)))
    pace = 0.03 * (1 - np.exp(-time / 0.2))
    angle = way / 0.1
    zero = np.zeros(steps)
    position = np.asarray(brush.p) + 0.1 * np.stack([zero, np.sin(angle), 1 - np.cos(angle)], axis=1)
    velocity = pace[:, None] * np.stack([zero, np.cos(angle), np.sin(angle)], axis=1)
    rotation = np.tile(np.asarray(brush.R).reshape(-1), (steps, 1))
    return np.concatenate([position, rotation, velocity, np.zeros((steps, 3)), np.ones((steps, 1))], axis=1)


def controller(limits, rows, base, parameters):
    """parameters: logarithms of the scales of gain, arm effort, base effort, manipulability, follow; and
    of speed.
    """
    scale = jnp.exp(parameters)
    settings = doubles(default_settings())
    settings = eqx.tree_at(
        lambda s: (
            s.position_gain,
            s.arm_effort,
            s.base_effort,
            s.manipulability,
            s.base_follow,
            s.qp_smoothing,
        ),
        settings,
        (
            settings.position_gain * scale[0],
            settings.arm_effort * scale[1],
            settings.base_effort * scale[2],
            settings.manipulability * scale[3],
            settings.base_follow * scale[4],
            jnp.asarray(1e-4),
        ),
    )
    thresholds = doubles(
        default_thresholds(release_margin=0.0, halt_temperature=0.05, release_temperature=0.05)
    )
    step, far = jnp.asarray(DT), base + jnp.asarray([0.0, 0.3, 0.0])
    reference, stations = Samples(rows, step, 0 * step), Samples(far[None], step, 0 * step)
    speed, duration = jnp.asarray(0.03), jnp.asarray(10.0)
    return WholeBodyController(limits, settings, thresholds, reference, stations, speed, scale[5], duration)


def loss(limits, noise, rows, arm, parameters):
    """Mean squared distance of the true brush from the plan [mm^2], from a start that is off by
    millimetres.
    """
    base, one = jnp.zeros(3), jnp.ones(4)
    follow = controller(limits, rows, base, parameters)
    world = standing(base, arm, Slip(0.01 * jnp.asarray([1, -1, 2, 0.5]), 0.01 * one), 4)
    _, record = run_block(
        follow,
        Kinematic(),
        limits,
        noise,
        jnp.asarray(DT),
        start(follow, Kinematic(), world),
        jax.random.key(0),
        records=RECORDS,
    )
    q = jnp.concatenate([record.base, record.arm], axis=-1)
    brush = jax.lax.map(lambda row: forward(limits.chain, row).p, q)
    return 1e6 * ((brush - record.planned) ** 2).sum(-1).mean()


def test_reverse_mode_agrees_with_central_differences(x64):
    robot = load_robot()
    limits = doubles(robot_limits(robot))
    noise = doubles(noise_preset("s1-simulation").odometry)
    home = doubles(robot.home)
    brush = forward(limits.chain, jnp.concatenate([jnp.zeros(3), home]))
    rows = jnp.asarray(circle(brush, 4 * RECORDS + 2))
    rng = np.random.default_rng(7)
    points = jnp.asarray(rng.uniform(-0.4, 0.4, (POINTS, 6)))
    arms = home + jnp.asarray(rng.uniform(-0.01, 0.01, (POINTS, 6)))
    both = batched(
        lambda limits, noise, rows, arm, p: jax.value_and_grad(lambda x: loss(limits, noise, rows, arm, x))(
            p
        ),
        in_axes=(None, None, None, 0, 0),
        chunk=10,
    )
    value, gradient = both(limits, noise, rows, arms, points)
    assert np.isfinite(value).all() and np.isfinite(gradient).all()
    assert (np.linalg.norm(gradient, axis=1) > 1e-3 * np.asarray(value)).all()
    once = batched(loss, in_axes=(None, None, None, 0, 0), chunk=10)
    h = 1e-6
    steps = h * np.concatenate([np.eye(6), -np.eye(6)])
    moved = (np.asarray(points)[:, None] + steps).reshape(-1, 6)
    values = np.asarray(once(limits, noise, rows, np.repeat(arms, 12, axis=0), moved)).reshape(POINTS, 12)
    difference = (values[:, :6] - values[:, 6:]) / (2 * h)
    off = np.linalg.norm(difference - np.asarray(gradient), axis=1) / np.linalg.norm(difference, axis=1)
    assert off.max() <= 1e-4, off
