"""Mecanum wheels: the textbook's signs, twist to wheels and back, odometry of what is no twist."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.steering import WheelMotion, mecanum

CORNERS = np.array([[0.28, 0.22], [0.28, -0.22], [-0.28, 0.22], [-0.28, -0.22]])


def wheels(angle=np.pi / 4, position=CORNERS):
    return mecanum(jnp.asarray(position), jnp.asarray(angle), jnp.asarray(1.2))


@pytest.mark.parametrize(
    ("twist", "signs"),
    [([1.0, 0, 0], [1, 1, 1, 1]), ([0, 1.0, 0], [-1, 1, 1, -1]), ([0, 0, 1.0], [-0.5, 0.5, -0.5, 0.5])],
)
def test_the_textbooks_signs(x64, twist, signs):
    """Forwards all alike; to the left, front left and rear right backwards; turning, the left side."""
    np.testing.assert_allclose(wheels().rolled(jnp.asarray(twist), jnp.zeros(4)), signs, atol=1e-12)


def test_a_rollers_axis_is_the_only_direction_that_is_driven(x64):
    """What the contact slides has no part along the roller's axis, which is `angle` off the axle.

    The axle is the base's y axis; front left the roller on the floor leans so that its inner end lies ahead.
    """
    rng = np.random.default_rng(0)
    for angle in (0.5, np.pi / 4, 1.0):
        for twist in rng.normal(size=(5, 3)):
            rim = np.asarray(wheels(angle).rolled(jnp.asarray(twist), jnp.zeros(4)))
            for (a, b), speed in zip(CORNERS, rim, strict=True):
                slip = np.array([twist[0] - twist[2] * b - speed, twist[1] + twist[2] * a])
                turn = np.sign(a * b) * angle  # from the axle, counter-clockwise
                roller = [-np.sin(turn), np.cos(turn)]
                assert abs(slip @ roller) < 1e-12


def test_rollers_near_the_axle_ask_more_of_the_rim_on_a_way_sideways(x64):
    """30 degrees off the axle: 1 m/s to the side is cot 30 = 1.732 m/s of the rim."""
    rim = wheels(np.pi / 6).rolled(jnp.asarray([0, 1.0, 0]), jnp.zeros(4))
    np.testing.assert_allclose(rim, np.sqrt(3) * np.array([-1, 1, 1, -1]), atol=1e-12)


def test_round_trip_is_the_identity_and_odometry_the_least_squares(x64):
    rng = np.random.default_rng(1)
    drive = wheels(0.7, CORNERS + np.array([0.05, 0.02]))
    twists = jnp.asarray(rng.normal(size=(200, 3)))
    still = jnp.zeros(4)
    back = jax.jit(jax.vmap(lambda t: drive.twist(still, drive.rolled(t, still))))(twists)
    np.testing.assert_allclose(back, twists, atol=1e-10)
    speeds = rng.normal(size=(20, 4))  # four numbers that no twist makes
    found = jax.jit(jax.vmap(lambda s: drive.odometry(WheelMotion(still, s, still))))(jnp.asarray(speeds))
    expected = [np.linalg.lstsq(np.asarray(drive.rows), s, rcond=None)[0] for s in speeds]
    np.testing.assert_allclose(found.twist, expected, atol=1e-10)
    left = np.asarray(expected) @ np.asarray(drive.rows).T - speeds
    np.testing.assert_allclose(found.residual, np.sqrt((left**2).mean(-1)), rtol=1e-8)


def test_nothing_steers_and_nothing_waits():
    angle, twist = jnp.zeros(4), jnp.asarray([0.0, 0.1, 0.2])
    assert wheels().size == 4
    assert wheels().nonholonomic_rows.shape == (0, 3)
    np.testing.assert_array_equal(wheels().steered(twist, angle, jnp.float32(0.02)), angle)
    assert float(wheels().readiness(twist, angle)) == 1
