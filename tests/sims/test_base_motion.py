"""The base's drives, its slip and its odometry."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from sims.driver import at_rest, drive
from sims.limits import robot_limits
from sims.noise import noise_preset, scaled
from sims.odometry import displacement, draw_slip, moved, reported_speed, wandering
from sims.robots import load_robot
from sims.sight import drift_of

DT = jnp.float32(0.02)


@pytest.fixture(scope="module")
def steering():
    return robot_limits(load_robot()).drive


@pytest.fixture(scope="module")
def noise():
    return noise_preset("s1-simulation").odometry


def driven(steering, twist, steps, start=0.0):
    wheels, twist = at_rest(jnp.full(4, jnp.float32(start))), jnp.asarray(twist)
    step = jax.jit(lambda w: drive(steering, w, twist, twist, jnp.float32(2.0), DT)[0])
    seen = []
    for _ in range(steps):
        after = step(wheels)
        seen.append((after.angle - wheels.angle, after.speed - wheels.speed))
        wheels = after
    return wheels, seen


def test_wheels_reach_the_twist_within_their_limits(steering):
    wheels, seen = driven(steering, [0.05, 0.08, 0.1], 100)
    np.testing.assert_allclose(steering.twist(wheels.angle, wheels.speed), [0.05, 0.08, 0.1], atol=1e-5)
    turns = np.abs(np.array([t for t, _ in seen])).max()
    assert 0 < turns <= float(steering.rate_limit * DT) * 1.001
    assert np.abs(np.array([s for _, s in seen])).max() <= 2.0 * 0.02 * 1.001


def test_a_module_that_points_across_does_not_push(steering):
    wheels, _ = driven(steering, [0.1, 0.0, 0.0], 1, start=np.pi / 2)
    assert np.abs(wheels.speed).max() < 0.01


def test_a_twist_that_is_too_fast_is_scaled_whole(steering):
    wheels, _ = driven(steering, [9.0, 0.0, 0.0], 200)
    np.testing.assert_allclose(np.abs(wheels.speed), steering.speed_limit, rtol=1e-4)


def test_creep_is_not_measured(noise):
    speed = jnp.asarray([0.0049, -0.0049, 0.0051, -0.3])
    np.testing.assert_allclose(reported_speed(noise, speed), [0, 0, 0.0051, -0.3], rtol=1e-6)


def test_slip_has_the_preset_spread_and_a_perfect_base_none(noise):
    slips = jax.vmap(lambda k: draw_slip(noise, 4, key=k))(jax.random.split(jax.random.key(0), 500))
    assert float(jnp.std(slips.steering)) == pytest.approx(float(noise.steering), rel=0.1)
    assert float(jnp.std(slips.radius)) == pytest.approx(float(noise.radius), rel=0.1)
    perfect = noise_preset("none").odometry
    assert not jax.tree.map(np.any, draw_slip(perfect, 4, key=jax.random.key(0))).steering
    twist = jnp.asarray([0.1, -0.05, 0.2])
    np.testing.assert_allclose(wandering(perfect, twist, jnp.float32(0.1), jnp.ones(3), DT), 0, atol=1e-9)


def test_a_metre_drifts_as_the_presets_unit_says(steering):
    """Half a radius and half a steering zero, and the turn that the wheels' places make of both."""
    unit = scaled(1.0).odometry
    ahead = jnp.asarray([1.0, 0.0, 0.0])
    angle, speed = jnp.zeros(4), steering.rolled(ahead, jnp.zeros(4))

    def off(key):
        slip = draw_slip(unit, 4, key=key)
        return steering.twist(angle + slip.steering, speed * (1 + slip.radius)) - ahead

    drift = jax.vmap(off)(jax.random.split(jax.random.key(2), 3000))
    np.testing.assert_allclose(jnp.std(drift, axis=0), [0.0005, 0.0026, 0.0057], rtol=0.06)
    model = drift_of(unit, steering)
    walk = float(unit.walk) ** 2, float(unit.walk) ** 2, float(unit.yaw_walk) ** 2
    known = jnp.sqrt(jnp.stack([model.along, model.across, model.yaw]) - jnp.asarray(walk))
    np.testing.assert_allclose(known, jnp.std(drift, axis=0), rtol=0.06)


def test_random_walk_grows_with_the_root_of_the_way(noise):
    def wander(key, steps):
        shocks = jax.random.normal(key, (steps, 3))
        ahead = jnp.asarray([0.1, 0, 0])
        return jax.vmap(lambda s: wandering(noise, ahead, jnp.zeros(()), s, DT))(shocks)[:, 1].sum()

    keys = jax.random.split(jax.random.key(1), 1500)
    for steps in (50, 200):
        spread = float(jnp.std(jax.vmap(lambda k, n=steps: wander(k, n))(keys)))
        assert spread == pytest.approx(float(noise.walk) * np.sqrt(0.1 * 0.02 * steps), rel=0.1)


def test_a_displacement_is_what_a_move_takes():
    rng = np.random.default_rng(3)
    for pose, motion in zip(rng.normal(size=(20, 3)), 0.3 * rng.normal(size=(20, 3)), strict=True):
        after = moved(jnp.asarray(pose), jnp.asarray(motion))
        np.testing.assert_allclose(displacement(jnp.asarray(pose), after), motion, atol=2e-6)


def test_moves_compose_on_the_plane():
    pose = jnp.asarray([1.0, 2.0, np.pi / 2])
    np.testing.assert_allclose(moved(pose, jnp.asarray([0.1, 0.0, 0.0])), [1.0, 2.1, np.pi / 2], atol=1e-6)
    around = jnp.zeros(3)
    for _ in range(100):
        around = moved(around, jnp.asarray([0.02 * np.pi, 0.0, 0.02 * np.pi]))
    np.testing.assert_allclose(around[:2], 0, atol=2e-3)
