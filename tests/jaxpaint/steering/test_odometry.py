"""The fit of a twist to points that move, against least squares as it is written, and where it is blind."""

import jax
import jax.numpy as jnp
import numpy as np

from jaxpaint.steering import rigid_twist
from jaxpaint.steering.odometry import point_velocity, rigid_residual, root_mean_square


def test_it_is_the_least_squares_of_all_equations(x64):
    rng = np.random.default_rng(0)
    for wheels in (2, 3, 4, 6):
        point, velocity = rng.normal(size=(2, wheels, 2))
        rows = np.zeros((wheels, 2, 3))
        rows[:, 0, 0], rows[:, 1, 1] = 1, 1
        rows[:, 0, 2], rows[:, 1, 2] = -point[:, 1], point[:, 0]
        rows, right = rows.reshape(-1, 3), velocity.reshape(-1)
        expected = np.linalg.lstsq(rows, right, rcond=None)[0]
        got = rigid_twist(jnp.asarray(point), jnp.asarray(velocity))
        np.testing.assert_allclose(got, expected, atol=1e-12)
        left = rigid_residual(got, jnp.asarray(point), jnp.asarray(velocity))
        np.testing.assert_allclose(left, np.sqrt(((rows @ expected - right) ** 2).mean()), rtol=1e-12)


def test_points_on_one_spot_show_no_turning():
    """A power of two, so that the spot is its own mean to the last bit."""
    got = rigid_twist(jnp.full((4, 2), 0.25), jnp.asarray([[0.1, 0.2]] * 4))
    np.testing.assert_allclose(got, [0.1, 0.2, 0.0], atol=1e-7)


def test_a_base_that_moves_as_one_leaves_nothing(x64):
    point, twist = jnp.asarray(np.random.default_rng(1).normal(size=(4, 2))), jnp.asarray([0.1, -0.2, 0.3])
    velocity = point_velocity(twist, point)
    np.testing.assert_allclose(rigid_twist(point, velocity), twist, atol=1e-14)
    assert float(rigid_residual(twist, point, velocity)) == 0


def test_a_residual_of_nothing_has_a_gradient_of_nothing():
    np.testing.assert_array_equal(jax.grad(root_mean_square)(jnp.zeros(3)), 0)
