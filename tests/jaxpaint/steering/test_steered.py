"""Wheels with their contacts under their axes: the branch turns least and does not tremble; zero speed."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.steering import SteeredWheels, WheelMotion, holonomic, wheel_commands, wrap
from jaxpaint.steering.odometry import point_velocity

CORNERS = np.array([(0.28, 0.22), (0.28, -0.22), (-0.28, 0.22), (-0.28, -0.22)])


def geometry(position=CORNERS, **more):
    return SteeredWheels(jnp.asarray(position), jnp.asarray(3.0), jnp.asarray(1.2), **more)


def test_round_trip_is_the_identity(x64):
    rng = np.random.default_rng(0)
    twists = rng.normal(size=(1000, 3))
    angles = rng.uniform(-np.pi, np.pi, (1000, 4))
    positions = rng.uniform(-0.5, 0.5, (1000, 4, 2))
    half, middle = np.abs(positions[:, 0]) + 0.1, positions[:, 1]
    corners = np.array([[1, 1], [1, -1], [-1, 1], [-1, -1]]) * half[:, None] + middle[:, None]

    def there_and_back(twist, angle, corner):
        g = geometry(corner)
        command = wheel_commands(g, twist, angle)
        return g.twist(command.angle, command.speed)

    back = jax.jit(jax.vmap(there_and_back))(twists, angles, corners)
    np.testing.assert_allclose(back, twists, atol=1e-10)


def test_a_creep_is_a_twist_too_where_still_is_less(x64):
    g = geometry(still=1e-12)
    twist = jnp.asarray([1e-6, -2e-6, 3e-6])
    command = wheel_commands(g, twist, jnp.zeros(4))
    np.testing.assert_allclose(g.twist(command.angle, command.speed), twist, rtol=1e-10)


def test_least_turn():
    rng = np.random.default_rng(1)
    g = geometry()
    for _ in range(50):
        angle = jnp.asarray(rng.uniform(-np.pi, np.pi, 4))
        target = wheel_commands(g, jnp.asarray(rng.normal(size=3)), angle).angle
        assert jnp.all(jnp.abs(target - angle) <= np.pi / 2 + 1e-5)


def test_at_rest_wheels_stay():
    angle, way = jnp.asarray([0.3, -0.2, 1.0, 2.0]), jnp.asarray([1.0, -1.0, 0.0, 1.0])
    command = wheel_commands(geometry(), jnp.zeros(3), angle, way)
    np.testing.assert_array_equal(command.angle, angle)
    np.testing.assert_array_equal(command.speed, 0)
    np.testing.assert_array_equal(command.way, way)


def test_a_wheel_in_the_centre_of_the_turn_keeps_its_angle_and_stands(x64):
    """The base turns about its first axis: the others roll round it."""
    twist = jnp.asarray([0.5 * CORNERS[0, 1], -0.5 * CORNERS[0, 0], 0.5])
    command = wheel_commands(geometry(), twist, jnp.full(4, 0.7))
    assert float(command.angle[0]) == 0.7
    assert abs(float(command.speed[0])) < 1e-15
    np.testing.assert_allclose(geometry().twist(command.angle, command.speed), twist, atol=1e-12)


def ways(noise, margin, way):
    """Which way the first wheel goes, step by step, for a demand across it, off by `noise` [rad]."""
    g, angle, seen = geometry(margin=margin), jnp.zeros(4), []
    command = jax.jit(lambda direction, way: wheel_commands(g, direction, angle, way))
    for off in noise:
        direction = jnp.asarray([np.cos(np.pi / 2 + off), np.sin(np.pi / 2 + off), 0])
        found = command(direction, way)
        way = found.way
        seen.append(float(way[0]))
    return np.array(seen)


def test_a_demand_that_trembles_across_a_wheel_does_not_change_its_way():
    """Without the margin nearly every second step does. A demand clearly on the other side does, with it."""
    noise = np.random.default_rng(2).uniform(-0.09, 0.09, 60)
    assert np.abs(np.diff(ways(noise, 0.0, jnp.ones(4)))).sum() / 2 > 20
    assert (ways(noise, 0.2, jnp.ones(4)) == 1).all()
    assert (ways(noise, 0.2, -jnp.ones(4)) == -1).all()
    np.testing.assert_array_equal(
        ways([0.05, 0.15, 0.05, -0.05, -0.15], 0.2, jnp.ones(4)), [1, -1, -1, -1, 1]
    )


def test_without_a_way_the_nearer_angle_is_taken_at_any_margin():
    np.testing.assert_array_equal(ways([-0.01], 0.2, jnp.zeros(4)), [1])
    np.testing.assert_array_equal(ways([0.01], 0.2, jnp.zeros(4)), [-1])


@pytest.mark.parametrize("way", [0.0, 1.0, -1.0])
def test_either_branch_makes_the_twist_and_turns_little_more_than_a_quarter(x64, way):
    rng = np.random.default_rng(3)
    g = geometry(margin=0.3)
    for _ in range(20):
        twist, angle = jnp.asarray(rng.normal(size=3)), jnp.asarray(rng.uniform(-3, 3, 4))
        command = wheel_commands(g, twist, angle, jnp.full(4, way))
        np.testing.assert_allclose(g.twist(command.angle, command.speed), twist, atol=1e-12)
        np.testing.assert_array_equal(jnp.sign(command.speed), command.way)
        assert float(jnp.abs(command.angle - angle).max()) <= np.pi / 2 + abs(way) * 0.15 + 1e-12


def test_odometry_tells_by_how_much_wheels_disagree(x64):
    """Four wheels ahead of which one stands askew by 0.1 rad: n . V of that one is left over, in part."""
    g, speed = geometry(), jnp.full(4, 0.5)
    straight = g.odometry(WheelMotion(jnp.zeros(4), speed, jnp.zeros(4)))
    np.testing.assert_allclose(straight.twist, [0.5, 0, 0], atol=1e-15)
    assert float(straight.residual) < 1e-15
    askew = g.odometry(WheelMotion(jnp.asarray([0.1, 0, 0, 0]), speed, jnp.zeros(4)))
    assert 0.005 < float(askew.residual) < 0.5 * 0.1 / np.sqrt(8)


def test_any_twist_is_theirs_in_the_end():
    assert geometry().nonholonomic_rows.shape == (0, 3)


def test_contacts_move_with_the_base():
    velocity = point_velocity(jnp.asarray([0.1, 0.2, 0.5]), jnp.asarray([[0.0, 0.0], [1.0, 2.0]]))
    np.testing.assert_allclose(velocity, [[0.1, 0.2], [0.1 - 1.0, 0.2 + 0.5]], rtol=1e-6)


def test_a_holonomic_base_makes_any_twist_in_one_step():
    drive = holonomic(jnp.float32(0.25), jnp.float32(1e3), jnp.float32(1e3))
    for twist in ([0.1, 0, 0], [0, -0.2, 0], [0, 0, 0.5], [-0.1, 0.2, 0.3]):
        angle = drive.steered(jnp.asarray(twist), jnp.full(4, 0.3), jnp.float32(0.02))
        assert float(drive.readiness(jnp.asarray(twist), angle)) == 1
        np.testing.assert_allclose(
            drive.twist(angle, drive.rolled(jnp.asarray(twist), angle)), twist, atol=1e-6
        )


def test_wrap():
    np.testing.assert_allclose(
        wrap(jnp.asarray([np.pi + 0.1, -np.pi - 0.1, 7.0])),
        [-np.pi + 0.1, np.pi - 0.1, 7.0 - 2 * np.pi],
        atol=1e-5,
    )
