"""Twist to wheels and back is the identity; the branch turns least; the printed matrix does not fit."""

import itertools

import jax
import jax.numpy as jnp
import numpy as np

from jaxpaint.steering import SteeredWheels, wrap
from jaxpaint.steering.steered import base_twist, contact_velocity, wheel_commands


def geometry(position=((0.28, 0.22), (0.28, -0.22), (-0.28, 0.22), (-0.28, -0.22))):
    return SteeredWheels(jnp.asarray(position), jnp.asarray(3.0), jnp.asarray(1.2))


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
    """S1-(9) for a wheel that rolls as it points: row 1 must give its speed over r, and row 2 no turning.

    Whatever signs the printed terms are given, no choice does both.
    """
    r, link, a, b = 0.1, 0.05, 0.28, 0.22
    vx, vy, w = 0.3, -0.2, 0.4
    v = np.asarray(contact_velocity(geometry(((a, b),) * 4), jnp.asarray([vx, vy, w])))[0]
    c, s = np.cos(np.arctan2(v[1], v[0])), np.sin(np.arctan2(v[1], v[0]))
    fits = 0
    for i, j, k, m in itertools.product([1, -1], repeat=4):
        rolling = (i * c * vx + j * s * vy + (k * a * s + m * b * c) * w) / r
        turning = (i * r * s * vx + j * r * c * vy + (link * r + k * b * r * s + m * a * r * c) * w) / (
            r * link
        )
        fits += abs(rolling - np.hypot(*v) / r) < 1e-6 and abs(turning) < 1e-6
    assert fits == 0
