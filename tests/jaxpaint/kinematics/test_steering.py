"""Twist to wheels and back is the identity; the branch turns least; the printed matrix does not fit."""

import itertools

import jax
import jax.numpy as jnp
import numpy as np

from jaxpaint.kinematics.steering import SteeringGeometry, base_twist, contact_velocity, wheel_commands, wrap


def geometry(position=((0.28, 0.22), (0.28, -0.22), (-0.28, 0.22), (-0.28, -0.22))):
    return SteeringGeometry(jnp.asarray(position), jnp.asarray(0.1), jnp.asarray(3.0), jnp.asarray(1.2))


def test_round_trip_is_the_identity(x64):
    rng = np.random.default_rng(0)
    twists = rng.normal(size=(1000, 3))
    angles = rng.uniform(-np.pi, np.pi, (1000, 4))
    positions = rng.uniform(-0.5, 0.5, (1000, 4, 2))
    # The normal equations are diagonal for wheels in a rectangle; the offset of its middle is free.
    half, middle = np.abs(positions[:, 0]) + 0.1, positions[:, 1]
    corners = np.array([[1, 1], [1, -1], [-1, 1], [-1, -1]]) * half[:, None] + middle[:, None]

    def there_and_back(twist, angle, corner):
        g = geometry(corner)
        return base_twist(g, *wheel_commands(g, twist, angle))

    back = jax.jit(jax.vmap(there_and_back))(twists, angles, corners)
    np.testing.assert_allclose(back, twists, atol=1e-10)


def test_least_turn():
    rng = np.random.default_rng(1)
    g = geometry()
    for _ in range(50):
        angle = jnp.asarray(rng.uniform(-np.pi, np.pi, 4))
        target, _ = wheel_commands(g, jnp.asarray(rng.normal(size=3)), angle)
        assert jnp.all(jnp.abs(target - angle) <= np.pi / 2 + 1e-5)


def test_at_rest_wheels_stay():
    angle = jnp.asarray([0.3, -0.2, 1.0, 2.0])
    target, speed = wheel_commands(geometry(), jnp.zeros(3), angle)
    np.testing.assert_array_equal(target, angle)
    np.testing.assert_array_equal(speed, 0)


def test_wrap():
    np.testing.assert_allclose(
        wrap(jnp.asarray([np.pi + 0.1, -np.pi - 0.1, 7.0])),
        [-np.pi + 0.1, np.pi - 0.1, 7.0 - 2 * np.pi],
        atol=1e-5,
    )


def test_printed_matrix_fits_no_signs():
    """S1-(9): a wheel without slip would have row 2 . twist = 0 for the steering it needs; no choice of signs does.

    Row 1 must be the rolling speed over r; row 2, for a steered wheel at rest in its steering (phi' = 0), must
    vanish. With l -> the printed entries, signs of its six terms are tried.
    """
    r, l, a, b = 0.1, 0.05, 0.28, 0.22
    twist = np.array([0.3, -0.2, 0.4])
    v = np.asarray(contact_velocity(geometry(((a, b),) * 4), jnp.asarray(twist)))[0]
    phi = np.arctan2(v[1], v[0])
    c, s = np.cos(phi), np.sin(phi)
    fits = 0
    for signs in itertools.product([1, -1], repeat=4):
        rolling = (
            signs[0] * l * c * twist[0]
            + signs[1] * l * s * twist[1]
            + (signs[2] * a * l * s + signs[3] * b * l * c) * twist[2]
        ) / (r * l)
        turning = (
            signs[0] * r * s * twist[0]
            + signs[1] * r * c * twist[1]
            + (l * r + signs[2] * b * r * s + signs[3] * a * r * c) * twist[2]
        ) / (r * l)
        fits += abs(rolling - np.hypot(*v) / r) < 1e-6 and abs(turning) < 1e-6
    assert fits == 0
