"""Driven casters: contacts that do not slip, found by moving them; pulled, pushed, and turning on."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.steering import CasterWheels, WheelMotion, driven

CORNERS = np.array([(0.28, 0.22), (0.28, -0.22), (-0.28, 0.22), (-0.28, -0.22)])
OFFSET = 0.06


def casters(position=CORNERS, offset=OFFSET):
    return CasterWheels(jnp.asarray(position), jnp.asarray(offset), jnp.asarray(3.0), jnp.asarray(1.2))


def contacts(pose, angle):
    """Where the contacts are in the plane, for a base at (x, y, yaw). [4, 2]"""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    inside = CORNERS + OFFSET * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    return pose[:2] + inside @ np.array([[c, s], [-s, c]])


def test_contacts_that_are_moved_do_not_slip(x64):
    """By differences of positions, which know nothing of the equations: the contact goes along the wheel."""
    rng, h = np.random.default_rng(0), 1e-6
    drive = casters()
    for _ in range(20):
        twist, angle, pose = rng.normal(size=3), rng.uniform(-3, 3, 4), rng.uniform(-3, 3, 3)
        speed = np.asarray(drive.rolled(jnp.asarray(twist), jnp.asarray(angle)))
        rate = np.asarray(drive.rates(jnp.asarray(twist), jnp.asarray(angle)))
        c, s = np.cos(pose[2]), np.sin(pose[2])
        step = h * np.array([c * twist[0] - s * twist[1], s * twist[0] + c * twist[1], twist[2]])
        moved = (contacts(pose + step, angle + h * rate) - contacts(pose - step, angle - h * rate)) / (2 * h)
        along = np.stack([np.cos(pose[2] + angle), np.sin(pose[2] + angle)], axis=-1)
        np.testing.assert_allclose(moved, speed[:, None] * along, atol=1e-8)


def deviations(start, seconds, twist=(0.2, 0.0, 0.0), h=1e-3):
    """Angles of wheels that start at `start` [rad] under a constant twist, by Runge-Kutta."""
    drive, twist = casters(), jnp.asarray(twist)

    def step(angle, _):
        k = [drive.rates(twist, angle)]
        for share in (0.5, 0.5, 1.0):
            k.append(drive.rates(twist, angle + share * h * k[-1]))
        return angle + h / 6 * (k[0] + 2 * k[1] + 2 * k[2] + k[3]), None

    return np.asarray(
        jax.jit(lambda a: jax.lax.scan(step, a, length=round(seconds / h))[0])(jnp.asarray(start))
    )


def test_pushed_wheels_come_round_and_pulled_ones_stay(x64):
    """tan(delta / 2) grows as exp(V t / l) from the way ahead, whatever the wheel: delta = pi is pulled."""
    start = np.array([1e-3, 0.5, 3.0, -2.0])
    expected = 2 * np.arctan(np.tan(start / 2) * np.exp(0.2 * 0.5 / OFFSET))
    np.testing.assert_allclose(deviations(start, 0.5), expected, rtol=1e-8)
    np.testing.assert_allclose(deviations(start, 6.0), np.pi * np.sign(start), atol=1e-4)


def test_a_pulled_wheel_rolls_backwards(x64):
    motion = driven(casters(), jnp.asarray([0.2, 0.0, 0.0]), jnp.full(4, np.pi), jnp.asarray(0.02)).motion
    np.testing.assert_allclose(motion.speed, -0.2)
    np.testing.assert_allclose(motion.rate, 0, atol=1e-12)


def test_the_law_does_not_flee_from_being_pushed(x64):
    """Exactly ahead nothing turns, for as long as nothing disturbs it."""
    np.testing.assert_array_equal(deviations(np.zeros(4), 1.0), 0)


def test_an_axis_near_the_centre_of_the_turn_finds_no_angle(x64):
    """The first axis moves with 0.02 m/s < l w = 0.06 m/s: it turns on, the others come to rest."""
    twist = (0.02 + CORNERS[0, 1], -CORNERS[0, 0], 1.0)
    early, late = (deviations(np.full(4, 2.0), t, twist) for t in (20.0, 40.0))
    assert abs(late[0] - early[0]) > 2 * np.pi
    np.testing.assert_allclose(late[1:], early[1:], atol=1e-6)


def test_at_zero_speed_nothing_turns():
    motion = driven(casters(), jnp.zeros(3), jnp.asarray([0.1, 2.0, -3.0, 0.0]), jnp.asarray(0.02)).motion
    np.testing.assert_array_equal(motion.speed, 0)
    np.testing.assert_array_equal(motion.rate, 0)
    assert casters().nonholonomic_rows.shape == (0, 3)
    assert float(casters().readiness(jnp.zeros(3), motion.angle)) == 1


def test_odometry_is_the_least_squares_of_all_equations(x64):
    """Against the rows as they are written: u . V = speed, n . V + l w = -l phi', for what no twist reads."""
    rng, drive = np.random.default_rng(1), casters()
    found = jax.jit(lambda motion: drive.odometry(motion))
    for _ in range(10):
        angle, speed, rate = rng.uniform(-3, 3, 4), *rng.normal(size=(2, 4))
        c, s, (a, b) = np.cos(angle), np.sin(angle), CORNERS.T
        rows = np.concatenate(
            [np.stack([c, s, a * s - b * c], axis=1), np.stack([-s, c, a * c + b * s + OFFSET], axis=1)]
        )
        right = np.concatenate([speed, -OFFSET * rate])
        twist = np.linalg.lstsq(rows, right, rcond=None)[0]
        got = found(WheelMotion(*(jnp.asarray(x) for x in (angle, speed, rate))))
        np.testing.assert_allclose(got.twist, twist, atol=1e-12)
        np.testing.assert_allclose(got.residual, np.sqrt(((rows @ twist - right) ** 2).mean()), rtol=1e-12)


def test_a_contact_that_trails_is_the_same_wheel_half_a_turn_round(x64):
    """An offset below 0 at an angle is that offset above 0 at the opposite one, its rim turning backwards."""
    rng = np.random.default_rng(2)
    for _ in range(10):
        twist, angle = jnp.asarray(rng.normal(size=3)), jnp.asarray(rng.uniform(-3, 3, 4))
        trails = driven(casters(offset=-OFFSET), twist, angle, jnp.asarray(0.02))
        leads = driven(casters(), twist, angle + np.pi, jnp.asarray(0.02))
        np.testing.assert_allclose(trails.motion.speed, -leads.motion.speed, atol=1e-14)
        np.testing.assert_allclose(trails.motion.rate, leads.motion.rate, atol=1e-12)
        np.testing.assert_allclose(trails.odometry.twist, leads.odometry.twist, atol=1e-13)
        np.testing.assert_allclose(trails.odometry.twist, trails.scale * twist, atol=1e-13)


def test_what_cannot_be_is_refused():
    for offset in (0.0, np.nan):
        with pytest.raises(ValueError, match=r"offset.*allowed: any number but 0"):
            casters(offset=offset)
    with pytest.raises(ValueError, match="allowed: odometry"):
        casters().twist(jnp.zeros(4), jnp.zeros(4))


def test_an_offset_may_be_traced():
    swept = jax.jit(jax.vmap(lambda offset: casters(offset=offset).rates(jnp.ones(3), jnp.zeros(4))))
    assert np.isfinite(swept(jnp.asarray([0.02, 0.15]))).all()
