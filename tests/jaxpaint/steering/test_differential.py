"""A differential base: identity on what it can make, projection of the rest, and the row that says which."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.steering import DifferentialWheels, WheelMotion, differential

STILL = jnp.zeros(2)


def base(track=0.5, axle=0.0):
    return differential(jnp.asarray(track), jnp.asarray(axle), jnp.asarray(1.2))


def around(drive, twist):
    return drive.twist(STILL, drive.rolled(jnp.asarray(twist), STILL))


def test_ahead_alike_and_to_the_left_the_right_wheel_faster():
    np.testing.assert_allclose(base().rolled(jnp.asarray([0.3, 0.0, 0.0]), STILL), [0.3, 0.3])
    np.testing.assert_allclose(base().rolled(jnp.asarray([0.0, 0.0, 1.0]), STILL), [-0.25, 0.25])


@pytest.mark.parametrize("axle", [0.0, -0.2])
def test_what_it_cannot_make_is_dropped_and_the_rest_stays(x64, axle):
    rng = np.random.default_rng(0)
    drive = base(axle=axle)
    for twist in rng.normal(size=(20, 3)):
        got = around(drive, twist)
        np.testing.assert_allclose(got, [twist[0], -axle * twist[2], twist[2]], atol=1e-12)
        np.testing.assert_allclose(around(drive, got), got, atol=1e-12)
        np.testing.assert_allclose(drive.nonholonomic_rows @ got, 0, atol=1e-12)
    assert drive.nonholonomic_rows.shape == (1, 3)


def test_the_row_holds_for_these_twists_alone(x64):
    G = np.asarray(base(axle=0.1).nonholonomic_rows)
    for twist in np.random.default_rng(1).normal(size=(20, 3)):
        makes = np.allclose(around(base(axle=0.1), twist), twist)
        assert makes == np.allclose(G @ twist, 0)
        twist = twist - G[0] * (G[0] @ twist) / (G[0] @ G[0])
        np.testing.assert_allclose(around(base(axle=0.1), twist), twist, atol=1e-12)


def test_more_wheels_on_the_axle_may_disagree_which_odometry_tells(x64):
    lateral, speed = np.array([0.3, 0.0, -0.2]), np.array([0.1, 0.5, 0.2])
    drive = DifferentialWheels(jnp.asarray(0.0), jnp.asarray(lateral), jnp.asarray(1.0))
    got = drive.odometry(WheelMotion(jnp.zeros(3), jnp.asarray(speed), jnp.zeros(3)))
    rows = np.stack([np.ones(3), -lateral], axis=1)
    expected = np.linalg.lstsq(rows, speed, rcond=None)[0]
    np.testing.assert_allclose(got.twist, [expected[0], 0, expected[1]], atol=1e-12)
    left = rows @ expected - speed
    np.testing.assert_allclose(got.residual, np.sqrt((left**2).sum() / 6), rtol=1e-12)
    two = base().odometry(WheelMotion(STILL, jnp.asarray([0.4, -0.1]), STILL))
    assert float(two.residual) < 1e-15


def test_nothing_steers_and_nothing_waits():
    twist = jnp.asarray([0.0, 0.1, 0.2])
    assert base().size == 2
    np.testing.assert_array_equal(base().steered(twist, STILL, jnp.asarray(0.02)), STILL)
    assert float(base().readiness(twist, STILL)) == 1


def test_a_batch_of_bases_is_one_program():
    tracks = jnp.asarray([0.3, 0.6])
    got = jax.jit(jax.vmap(lambda t: base(t).rolled(jnp.asarray([0.0, 0.0, 1.0]), STILL)))(tracks)
    np.testing.assert_allclose(got, [[-0.15, 0.15], [-0.3, 0.3]])
