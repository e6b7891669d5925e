"""All kinds of base in worlds: they make what they are told, odometry sees it, and wheels do not tremble."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from jax.test_util import check_grads

from jaxpaint.steering import CasterWheels, SteeredWheels, differential, mecanum, rigid_twist
from opt.controller import Command, Controller, Decision
from sims.dynamics import dynamic
from sims.limits import robot_limits
from sims.noise import noise_preset
from sims.odometry import no_slip
from sims.robots import load_robot, robot_model
from sims.rollout import RECORD_EVERY, run_block, start
from sims.worlds import RIM_ACCELERATION, Kinematic, standing

CORNERS = np.array([(0.28, 0.22), (0.28, -0.22), (-0.28, 0.22), (-0.28, -0.22)])
RATE, SPEED, DT, AXLE = 3.0, 1.2, 0.02, -0.1
KINDS = ["steered", "caster", "trailing", "mecanum", "differential"]


def base(kind, dtype=jnp.float32):
    position, one = jnp.asarray(CORNERS, dtype), jnp.ones((), dtype)
    return {
        "steered": SteeredWheels(position, RATE * one, SPEED * one),
        "caster": CasterWheels(position, 0.06 * one, RATE * one, SPEED * one),
        "trailing": CasterWheels(position, -0.06 * one, RATE * one, SPEED * one),
        "mecanum": mecanum(position, 0.7 * one, SPEED * one),
        "differential": differential(0.5 * one, AXLE * one, SPEED * one),
    }[kind]


def possible(kind, twist):
    """The twist, or what a differential base can make of it."""
    return [twist[0], -AXLE * twist[2], twist[2]] if kind == "differential" else twist


@pytest.fixture(scope="module")
def limits():
    return robot_limits(load_robot())


@pytest.fixture(scope="module")
def perfect():
    return noise_preset("none").odometry


def at_rest(limits, drive):
    one = jnp.ones((), jnp.result_type(drive.speed_limit))
    arm = jnp.zeros(6, one.dtype)
    return eqx.tree_at(lambda r: r.drive, limits, drive), standing(
        jnp.zeros(3, one.dtype), arm, no_slip(drive.size, one.dtype), drive.size
    )


def run(limits, noise, drive, twists, steers=None, fidelity=None):
    """The worlds after each step of twists. [steps, 3]"""
    robot, world = at_rest(limits, drive)
    fidelity = Kinematic() if fidelity is None else fidelity
    twists = jnp.asarray(twists, world.base.dtype)
    steers = twists if steers is None else jnp.asarray(steers, world.base.dtype)

    def step(world, told):
        command = Command(*told, jnp.zeros_like(world.arm))
        world = fidelity.step(robot, noise, world, command, jnp.zeros(3), jnp.asarray(DT, twists.dtype))
        return world, world

    return jax.jit(lambda told: jax.lax.scan(step, fidelity.begin(world), told)[1])((twists, steers))


def driven(worlds):
    """Twists in the base frame that the true bases made, step by step. [steps - 1, 3]"""
    pose = np.asarray(worlds.base, float)
    step, yaw = np.diff(pose, axis=0) / DT, (pose[1:, 2] + pose[:-1, 2]) / 2
    c, s = np.cos(yaw), np.sin(yaw)
    return np.stack([c * step[:, 0] + s * step[:, 1], c * step[:, 1] - s * step[:, 0], step[:, 2]], axis=1)


@pytest.mark.parametrize("kind", KINDS)
def test_every_base_comes_to_make_its_twist_and_odometry_follows(limits, perfect, kind):
    twist = possible(kind, [0.1, 0.06, 0.15])
    worlds = run(limits, perfect, base(kind), [twist] * 150)
    np.testing.assert_allclose(driven(worlds)[-50:], np.tile(twist, (50, 1)), atol=2e-4)
    np.testing.assert_allclose(worlds.odometry, worlds.base, atol=1e-6)
    assert np.asarray(worlds.residual)[-50:].max() < 1e-5
    assert (np.asarray(worlds.residual) >= 0).all()


@pytest.mark.parametrize("kind", KINDS)
def test_limits_hold_whatever_is_asked(limits, perfect, kind):
    rng = np.random.default_rng(0)
    twists = np.repeat(rng.normal(size=(20, 3)) * np.exp(rng.uniform(-3, 2, (20, 1))), 15, axis=0)
    worlds = run(limits, perfect, base(kind), twists)
    speed, angle = np.asarray(worlds.wheels.speed), np.asarray(worlds.wheels.angle)
    assert 0.3 * SPEED < np.abs(speed).max() <= SPEED * (1 + 1e-5)
    assert np.abs(np.diff(speed, axis=0)).max() <= RIM_ACCELERATION * DT * (1 + 1e-4)
    turned = np.abs(np.diff(angle, axis=0)).max()
    assert turned <= RATE * DT * (1 + 1e-3)
    assert turned >= RATE * DT * (1 - 1e-3) or kind in ("mecanum", "differential")
    assert np.isfinite(worlds.residual).all()
    if kind != "differential":  # two wheels always agree
        assert np.asarray(worlds.residual).max() > 1e-3


def test_odometry_of_casters_needs_their_rates(limits, perfect):
    """While they come round: speeds and angles alone would tell another way."""
    drive = base("caster")
    worlds = run(limits, perfect, drive, [[0.1, 0.0, 0.0]] * 10 + [[0.0, 0.1, 0.0]] * 60)
    np.testing.assert_allclose(worlds.odometry, worlds.base, atol=1e-6)
    turning = slice(11, 30)
    angle, speed = (np.asarray(x)[turning] for x in (worlds.wheels.angle, worlds.wheels.speed))
    assert np.abs(np.diff(angle, axis=0)).max() > 0.02
    along = np.stack([speed * np.cos(angle), speed * np.sin(angle)], axis=-1)
    without = np.stack([rigid_twist(drive.position, jnp.asarray(v)) for v in along])
    assert np.abs(without - driven(worlds)[10:29]).max() > 0.03


@pytest.mark.parametrize("kind", ["steered", "mecanum", "differential"])
def test_a_creep_is_not_measured(limits, perfect, kind):
    noise = eqx.tree_at(lambda n: n.dead_band, perfect, jnp.float32(0.005))
    for speed, seen in ((0.004, False), (0.006, True)):
        worlds = run(limits, noise, base(kind), [[speed, 0.0, 0.0]] * 50)
        assert float(worlds.base[-1, 0]) == pytest.approx(50 * DT * speed, rel=0.02)
        np.testing.assert_allclose(worlds.odometry[-1], seen * worlds.base[-1], atol=1e-6)


def test_rims_of_casters_have_a_dead_band_and_their_axes_none(limits, perfect):
    """Sideways all motion is read from the axes; ahead none is."""
    noise = eqx.tree_at(lambda n: n.dead_band, perfect, jnp.float32(0.005))
    ahead = run(limits, noise, base("trailing"), [[0.004, 0.0, 0.0]] * 50)
    assert float(ahead.base[-1, 0]) == pytest.approx(0.004, rel=0.02)
    np.testing.assert_allclose(ahead.odometry[-1], 0, atol=1e-6)
    aside = run(limits, noise, base("trailing"), [[0.0, 0.004, 0.0]] * 5)
    np.testing.assert_allclose(aside.odometry[-1], aside.base[-1], atol=2e-6)
    assert float(aside.base[-1, 1]) == pytest.approx(5 * DT * 0.004, rel=0.02)


def trembling(limits, perfect, drive):
    """Angles of the first wheel, which goes ahead and is then asked for a quarter turn that trembles."""
    off = 0.08 * np.where(np.arange(60) % 2, 1, -1)
    across = np.stack([-np.sin(off), np.cos(off), np.zeros(60)], axis=1)
    steers = np.concatenate([[[0.1, 0.0, 0.0]] * 5, 0.1 * across])
    twists = np.concatenate([[[0.1, 0.0, 0.0]] * 5, np.zeros((60, 3))])
    return np.asarray(run(limits, perfect, drive, twists, steers).wheels.angle)[4:, 0]


def test_wheels_keep_their_way_at_a_quarter_turn(limits, perfect):
    """Without a margin the wheel stays where it was, to and fro."""
    drive = base("steered")
    angle = trembling(limits, perfect, drive)
    assert (np.diff(angle)[:20] > 0.05).all()
    np.testing.assert_allclose(angle[-10:], np.pi / 2, atol=0.09)
    none = trembling(limits, perfect, eqx.tree_at(lambda d: d.margin, drive, jnp.float32(0.0)))
    assert np.abs(none).max() < 0.2


class Always(Controller):
    """The same command in every step."""

    twist: jax.Array
    duration: jax.Array

    def initial(self, measured):
        return ()

    def surface(self, clock):
        return None

    def decide(self, memory, measured, clock, dt):
        one = jnp.ones_like(clock)
        command = Command(self.twist, self.twist, jnp.zeros_like(measured.arm))
        return Decision(command, one, jnp.zeros(3), one, 0 * one, jnp.int32(0)), memory


def test_a_rollout_sums_up_the_residual_of_its_live_steps(limits, perfect):
    twist, records = [0.1, 0.2, 0.3], 10
    robot, world = at_rest(limits, base("steered"))
    follow = Always(jnp.asarray(twist), jnp.float32(30 * DT - 0.001))  # the last ten steps are not lived
    state, _ = jax.jit(
        lambda world, key: run_block(
            follow,
            Kinematic(),
            robot,
            perfect,
            jnp.float32(DT),
            start(follow, Kinematic(), world),
            key,
            records=records,
        )
    )(world, jax.random.key(0))
    assert records * RECORD_EVERY == 40 and int(state.steps) == 30
    residual = np.asarray(run(limits, perfect, base("steered"), [twist] * 30).residual)
    assert residual.max() > 0.005
    np.testing.assert_allclose(state.residual_most, residual.max(), rtol=1e-5)
    np.testing.assert_allclose(state.residual_sum, residual.sum(), rtol=1e-5)


@pytest.mark.parametrize("kind", KINDS)
def test_gradients_go_through_the_wheels(x64, kind):
    """Where the base ends up by the twist it is told; not where a branch changes or a limit begins."""
    double = jax.tree.map(lambda x: jnp.asarray(x, jnp.float64), robot_limits(load_robot()))
    noise = jax.tree.map(lambda x: jnp.asarray(x, jnp.float64), noise_preset("none").odometry)

    def end(twist):
        worlds = run(double, noise, base(kind, jnp.float64), jnp.broadcast_to(twist, (20, 3)))
        return worlds.base[-1], worlds.odometry[-1]

    check_grads(
        end, (jnp.asarray([0.317, 0.12, 0.2]),), order=1, modes=("rev",), atol=1e-6, rtol=1e-5, eps=1e-6
    )


@pytest.mark.parametrize("kind", ["caster", "differential"])
def test_bases_with_masses_follow_too(limits, perfect, kind):
    twist = possible(kind, [0.1, 0.06, 0.15])
    worlds = run(limits, perfect, base(kind), [twist] * 150, fidelity=dynamic(robot_model()))
    np.testing.assert_allclose(driven(worlds)[-25:], np.tile(twist, (25, 1)), atol=3e-3)
    np.testing.assert_allclose(worlds.odometry, worlds.base, atol=1e-5)
