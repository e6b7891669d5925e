"""Plans through waypoints: continuous, within limits, base and arm on one clock."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.trajectories import Limits, plan_base_and_arm, sample, slowed

V = np.array([0.5, 0.5, 1.0, *[np.pi] * 6])
A = np.array([0.5, 0.5, 1.0, *[8.0] * 6])
MASK = np.array([True, True, False, True, True, True])


@pytest.fixture(scope="module")
def waypoints():
    """Six of them: the third masked and not a number, the fifth the same as the fourth."""
    points = np.random.default_rng(0).uniform(-1, 1, (6, 9))
    points[2], points[4] = np.nan, points[3]
    return points


def planned(waypoints, mask=MASK, rest=0.0):
    limits = Limits(jnp.asarray(V), jnp.asarray(A))
    return jax.jit(plan_base_and_arm)(jnp.asarray(waypoints), jnp.asarray(mask), limits, rest)


SAMPLE = jax.jit(jax.vmap(sample, in_axes=(None, 0)))


def sampled(trajectory, count=3000):
    times = jnp.linspace(-0.1, trajectory.duration + 0.1, count)
    return jax.tree.map(np.asarray, SAMPLE(trajectory, times)), np.asarray(times)


def test_limits_are_kept_and_one_is_reached_in_each_segment(waypoints, x64):
    trajectory = planned(waypoints)
    s, times = sampled(trajectory)
    slack = 1 + 1e-5
    assert (np.abs(s.v) <= V * slack).all() and (np.abs(s.a) <= A * slack).all()
    for begin, long in zip(trajectory.start, trajectory.segments, strict=True):
        inside = (times >= begin) & (times < begin + long)
        if inside.any():
            assert max((np.abs(s.v[inside]) / V).max(), (np.abs(s.a[inside]) / A).max()) > 0.7


def test_position_speed_and_acceleration_are_continuous(waypoints, x64):
    """Each is the sum of the next: what jumped in p, v or a would not add up."""
    s, times = sampled(planned(waypoints, rest=0.1), 40001)
    step = times[1] - times[0]
    np.testing.assert_allclose(np.diff(s.p, axis=0), step * (s.v[1:] + s.v[:-1]) / 2, atol=1e-7)
    np.testing.assert_allclose(np.diff(s.v, axis=0), step * (s.a[1:] + s.a[:-1]) / 2, atol=1e-5)
    assert np.abs(np.diff(s.a, axis=0)).max() < 0.01 * np.abs(s.a).max()


def test_it_rests_at_every_waypoint_that_is_kept(waypoints, x64):
    trajectory = planned(waypoints, rest=0.3)
    kept = waypoints[[0, 1, 1, 3, 3, 5]]
    for late in (0.0, 0.29):
        at = SAMPLE(trajectory, trajectory.arrival + np.where(MASK, late, 0))
        np.testing.assert_allclose(at.p, kept, atol=1e-12)
        np.testing.assert_allclose(at.v, 0, atol=1e-12)
    np.testing.assert_allclose(trajectory.segments[np.array([1, 3])], 0)
    assert float(trajectory.duration) == pytest.approx(float(trajectory.segments.sum()) + 5 * 0.3)
    ends, _ = sampled(trajectory, 2)
    np.testing.assert_allclose(ends.p, waypoints[[0, 5]], atol=1e-12)
    np.testing.assert_array_equal(ends.v, 0)


def test_the_faster_of_base_and_arm_waits_for_the_other(x64):
    """A short way of the base beside a long one of the arm, and the other way round."""
    points = np.zeros((3, 9))
    points[1:, 3] = 3.0
    points[1, :3], points[2, :3] = [0.01, 0, 0], [1.01, 0, 0]
    both = planned(points, np.ones(3, bool))
    base = planned(points * (np.arange(9) < 3), np.ones(3, bool))
    arm = planned(points * (np.arange(9) >= 3), np.ones(3, bool))
    np.testing.assert_allclose(both.segments, [arm.segments[0], base.segments[1]])
    assert base.segments[0] < arm.segments[0] and arm.segments[1] == 0
    # both arrive together, and neither before
    _, times = sampled(both)
    last = times[(times < both.arrival[1])][-1] - 0.02
    now = SAMPLE(both, jnp.asarray([last]))
    assert abs(float(now.v[0, 0])) > 0 and abs(float(now.v[0, 3])) > 0


def test_the_bases_speed_is_limited_along_its_line(x64):
    """A diagonal of the same length takes as long as a straight way, and the base keeps to the line."""
    lengths = []
    for angle in (0.0, np.pi / 4):
        points = np.zeros((3, 9))
        points[1, :3] = [2 * np.cos(angle), 2 * np.sin(angle), 0.3]
        trajectory = planned(points, np.arange(3) < 2)
        lengths.append(float(trajectory.duration))
        s, _ = sampled(trajectory, 101)
        assert np.linalg.norm(s.v[:, :2], axis=1).max() <= 0.5 * (1 + 1e-5)
        np.testing.assert_allclose(s.p[:, 0] * np.sin(angle), s.p[:, 1] * np.cos(angle), atol=1e-12)
    assert lengths[0] == pytest.approx(lengths[1])


def test_slowing_down_keeps_the_way_and_the_rests(waypoints, x64):
    trajectory = planned(waypoints, rest=0.2)
    late = jax.jit(slowed)(trajectory, jnp.full(5, 2.0))
    np.testing.assert_allclose(late.segments, 2 * trajectory.segments)
    np.testing.assert_allclose(late.rest, trajectory.rest)
    now, then = (SAMPLE(t, t.start[:1] + 0.4 * t.segments[:1]) for t in (trajectory, late))
    np.testing.assert_allclose(now.p, then.p)
    np.testing.assert_allclose(now.v, 2 * then.v)
    np.testing.assert_allclose(now.a, 4 * then.a)


def test_gradients_are_finite_where_nothing_moves():
    limits = Limits(jnp.asarray(V), jnp.asarray(A))

    def late(points, t):
        trajectory = plan_base_and_arm(points, jnp.ones(3, bool), limits)
        s = sample(trajectory, t)
        return (s.p + s.v + s.a).sum() + trajectory.duration

    slopes = jax.jit(jax.grad(late, argnums=(0, 1)))
    still = jnp.zeros((3, 9), jnp.float32)
    for points in (still, still.at[2:, 4].set(1.0), still.at[1:, 0].set(1.0)):
        assert all(bool(jnp.isfinite(x).all()) for x in slopes(points, jnp.asarray(0.1)))
