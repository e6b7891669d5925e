"""With limits on, no rim and no steering axis is above its own, and the twist keeps its direction."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.compiling import batched
from jaxpaint.steering import CasterWheels, SteeredWheels, differential, driven, limited, mecanum

CORNERS = np.array([(0.28, 0.22), (0.28, -0.22), (-0.28, 0.22), (-0.28, -0.22)])
CASES, RATE, SPEED, DT = 10_000, 3.0, 1.2, 0.02


def steered(offset):
    one = jnp.ones_like(offset)
    return SteeredWheels(jnp.asarray(CORNERS, offset.dtype), RATE * one, SPEED * one)


def caster(offset):
    one = jnp.ones_like(offset)
    return CasterWheels(jnp.asarray(CORNERS, offset.dtype), offset, RATE * one, SPEED * one)


def with_rollers(offset):
    one = jnp.ones_like(offset)
    return mecanum(jnp.asarray(CORNERS, offset.dtype), 0.7 * one, SPEED * one)


def two_wheels(offset):
    one = jnp.ones_like(offset)
    return differential(0.5 * one, 0 * one, SPEED * one)


def one_step(kind, twist, angle, offset):
    drive = kind(offset)
    angle = angle[: drive.size]
    step = driven(drive, twist, angle, jnp.asarray(DT, twist.dtype))
    return step, drive.load(step.scale * twist, step.motion.angle), limited(drive, twist, step.motion.angle)


def drawn(dtype=float):
    rng = np.random.default_rng(0)
    twists = rng.normal(size=(CASES, 3)) * np.exp(rng.uniform(-3, 2, (CASES, 1)))
    angles, offsets = rng.uniform(-np.pi, np.pi, (CASES, 4)), rng.uniform(0.02, 0.15, CASES)
    return [jnp.asarray(x, dtype) for x in (twists, angles, offsets)]


@pytest.mark.parametrize("kind", [steered, caster, with_rollers, two_wheels])
@pytest.mark.parametrize("double", [True, False])
def test_no_limit_is_exceeded_and_the_factor_is_the_largest(kind, double):
    hair = 1e-12 if double else 2e-5  # a rate of a short twist is a small difference over a short offset
    with jax.enable_x64(double):
        cases = drawn(jnp.float64 if double else jnp.float32)
        found = jax.jit(jax.vmap(lambda *case: one_step(kind, *case)))(*cases)
        twists, (step, load, asked) = np.asarray(cases[0]), jax.tree.map(np.asarray, found)
    assert np.abs(step.motion.speed).max() <= SPEED * (1 + hair)
    assert np.abs(step.motion.rate).max() <= RATE * (1 + hair)
    scale = step.scale
    assert (scale > 0).all() and (scale <= 1).all() and (scale == 1).any() and (scale < 1).any()
    np.testing.assert_allclose(load[scale < 1], 1, rtol=hair)
    np.testing.assert_allclose(asked.scale, scale, rtol=hair)
    np.testing.assert_allclose(asked.twist, scale[:, None] * twists, rtol=hair)
    assert np.isfinite(step.odometry.residual).all()
    if kind in (caster, with_rollers):  # theirs at once: they drive the scaled twist, and agree
        np.testing.assert_allclose(step.odometry.twist, asked.twist, atol=10 * hair)
        assert step.odometry.residual.max() < 10 * hair


def test_a_scaled_twist_of_casters_is_that_of_its_slowest_axis(x64):
    """By hand: sideways 0.3 m/s on 2 cm ask for 15 rad/s of axes that make 3."""
    drive = caster(jnp.asarray(0.02))
    got = limited(drive, jnp.asarray([0.0, 0.3, 0.0]), jnp.zeros(4))
    np.testing.assert_allclose(got.scale, 0.2)
    np.testing.assert_allclose(got.twist, [0, 0.06, 0])
    np.testing.assert_allclose(drive.steered(jnp.asarray([0.0, 0.3, 0.0]), jnp.zeros(4), DT), -3.0 * DT)


def follow(kind, twist, angle, steps, offset=0.05):
    """Angles, odometry and scale of step after step of one twist."""
    drive = kind(jnp.asarray(offset))

    def step(angle, _):
        done = driven(drive, jnp.asarray(twist), angle, jnp.asarray(DT))
        return done.angle, done

    return jax.jit(lambda a: jax.lax.scan(step, a, length=steps)[1])(jnp.asarray(angle))


def test_wheels_that_are_not_there_yet_scrub_and_odometry_says_so(x64):
    """The residual falls to nothing as they turn; the twist that is driven grows into the one asked for."""
    twist = np.array([0.1, 0.2, 0.3])
    done = follow(steered, twist, [0.0, 0.4, -1.0, 2.0], 60)
    residual, off = np.asarray(done.odometry.residual), np.abs(np.asarray(done.odometry.twist) - twist).max(1)
    assert residual[0] > 0.01 and off[0] > 0.05
    assert residual[-1] < 1e-15 and off[-1] < 1e-12
    turned = np.diff(np.asarray(done.angle), axis=0)
    assert np.abs(turned).max() <= RATE * DT * (1 + 1e-12)
    assert np.abs(turned).max() >= RATE * DT * (1 - 1e-12)


def test_a_wheel_across_its_way_pushes_nothing(x64):
    done = follow(steered, [0.1, 0.0, 0.0], [np.pi / 2] * 4, 1)
    assert np.abs(done.motion.speed).max() < 0.1 * np.sin(RATE * DT) * 1.001


def test_casters_make_the_twist_at_once_while_they_come_round(x64):
    """From ahead, a hair off: half a turn within limits, and no step without the twist or its share."""
    twist = np.array([0.2, 0.0, 0.0])
    done = follow(caster, twist, [0.01, -0.01, 1.0, 3.0], 400)
    np.testing.assert_allclose(done.odometry.twist, np.asarray(done.scale)[:, None] * twist, atol=1e-14)
    assert np.asarray(done.odometry.residual).max() < 1e-14
    assert np.asarray(done.scale).min() < 1
    np.testing.assert_allclose(np.abs(done.angle[-1]), np.pi, atol=1e-3)


def test_a_twist_of_nothing_moves_nothing():
    for kind in (steered, caster, with_rollers, two_wheels):
        angle = jnp.asarray([0.1, 0.2, 0.3, 0.4])[: kind(jnp.float32(0.1)).size]
        done = jax.jit(driven)(kind(jnp.float32(0.1)), jnp.zeros(3), angle, jnp.float32(DT))
        np.testing.assert_array_equal(done.angle, angle)
        np.testing.assert_array_equal(done.motion.speed, 0)
        np.testing.assert_array_equal(done.motion.rate, 0)
        np.testing.assert_array_equal(done.odometry.twist, 0)
        assert float(done.scale) == 1


@pytest.mark.parametrize("kind", [steered, caster])
def test_many_worlds_are_each_as_one(kind):
    cases = [x[:40] for x in drawn(jnp.float32)]
    many = batched(lambda *case: one_step(kind, *case)[0], in_axes=(0, 0, 0))(*cases)
    alone = jax.jit(jax.vmap(lambda *case: one_step(kind, *case)[0]))(*cases)
    for one, other in zip(jax.tree.leaves(many), jax.tree.leaves(alone), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-4, atol=1e-5)
