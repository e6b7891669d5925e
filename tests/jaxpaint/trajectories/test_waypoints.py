"""Plans through waypoints: continuous, within limits, base and arm on one clock."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.trajectories import plan, plan_base_and_arm, sample

V = np.array([0.5, 0.5, 1.0, *[np.pi] * 6])
A = np.array([0.5, 0.5, 1.0, *[8.0] * 6])


@pytest.fixture(scope="module")
def waypoints():
    """Six of them: the third masked and not a number, the fifth the same as the fourth."""
    points = np.random.default_rng(0).uniform(-1, 1, (6, 9))
    points[2], points[4] = np.nan, points[3]
    return points


MASK = np.array([True, True, False, True, True, True])


def planned(waypoints, planner):
    return jax.jit(planner)(*map(jnp.asarray, (waypoints, MASK, V, A)))


def sampled(trajectory, count=3000):
    times = jnp.linspace(-0.1, trajectory.duration + 0.1, count)
    return jax.tree.map(
        np.asarray, jax.jit(jax.vmap(sample, in_axes=(None, 0)))(trajectory, times)
    ), np.asarray(times)


@pytest.mark.parametrize("planner", [plan, plan_base_and_arm])
def test_limits_are_kept_and_one_is_reached_in_each_segment(planner, waypoints, x64):
    trajectory = planned(waypoints, planner)
    s, times = sampled(trajectory)
    slack = 1 + 1e-5
    assert (np.abs(s.v) <= V * slack).all() and (np.abs(s.a) <= A * slack).all()
    for begin, end in zip(trajectory.start[:-1], trajectory.start[1:], strict=True):
        inside = (times >= begin) & (times < end)
        if inside.any():
            assert max((np.abs(s.v[inside]) / V).max(), (np.abs(s.a[inside]) / A).max()) > 0.7


def test_position_speed_and_acceleration_are_continuous(waypoints, x64):
    """Each is the sum of the next: what jumped in p, v or a would not add up."""
    s, times = sampled(planned(waypoints, plan_base_and_arm), 20001)
    step = times[1] - times[0]
    np.testing.assert_allclose(np.diff(s.p, axis=0), step * (s.v[1:] + s.v[:-1]) / 2, atol=1e-6)
    np.testing.assert_allclose(np.diff(s.v, axis=0), step * (s.a[1:] + s.a[:-1]) / 2, atol=1e-4)
    assert np.abs(np.diff(s.a, axis=0)).max() < 0.02 * np.abs(s.a).max()


def test_it_stops_at_every_waypoint_that_is_kept(waypoints, x64):
    trajectory = planned(waypoints, plan)
    at = jax.jit(jax.vmap(sample, in_axes=(None, 0)))(trajectory, trajectory.start)
    kept = waypoints[[0, 1, 1, 3, 3, 5]]
    np.testing.assert_allclose(at.p, kept, atol=1e-12)
    np.testing.assert_allclose(at.v, 0, atol=1e-12)
    np.testing.assert_allclose(trajectory.segments[np.array([1, 3])], 0)
    ends, _ = sampled(trajectory, 2)
    np.testing.assert_allclose(ends.p, waypoints[[0, 5]], atol=1e-12)
    np.testing.assert_array_equal(ends.v, 0)


def test_base_and_arm_take_the_longer_of_their_times(x64):
    """A short way of the base beside a long one of the arm, and the other way round."""
    points = np.zeros((3, 9))
    points[1:, 3] = 3.0
    points[1, :3], points[2, :3] = [0.01, 0, 0], [1.01, 0, 0]
    mask = np.ones(3, bool)
    together = jax.jit(plan_base_and_arm)(*map(jnp.asarray, (points, mask, V, A))).segments
    base = jax.jit(plan)(*map(jnp.asarray, (points[:, :3], mask, V[:3], A[:3]))).segments
    arm = jax.jit(plan)(*map(jnp.asarray, (points[:, 3:], mask, V[3:], A[3:]))).segments
    np.testing.assert_allclose(together, [arm[0], base[1]])
    assert base[0] < arm[0] and arm[1] == 0


def test_the_bases_speed_is_limited_along_its_line(x64):
    """A diagonal of the same length takes as long as a straight way, and the base keeps to the line."""
    lengths = []
    for angle in (0.0, np.pi / 4):
        points = np.zeros((2, 9))
        points[1, :3] = [2 * np.cos(angle), 2 * np.sin(angle), 0.3]
        trajectory = jax.jit(plan_base_and_arm)(*map(jnp.asarray, (points, np.ones(2, bool), V, A)))
        lengths.append(float(trajectory.duration))
        s, _ = sampled(trajectory, 101)
        assert np.linalg.norm(s.v[:, :2], axis=1).max() <= 0.5 * (1 + 1e-5)
        np.testing.assert_allclose(s.p[:, 0] * np.sin(angle), s.p[:, 1] * np.cos(angle), atol=1e-12)
    assert lengths[0] == pytest.approx(lengths[1])


def test_gradients_are_finite_where_nothing_moves():
    def late(points, t):
        trajectory = plan_base_and_arm(points, jnp.ones(3, bool), jnp.asarray(V), jnp.asarray(A))
        s = sample(trajectory, t)
        return (s.p + s.v + s.a).sum() + trajectory.duration

    slopes = jax.jit(jax.grad(late, argnums=(0, 1)))
    still = jnp.zeros((3, 9), jnp.float32)
    for points in (still, still.at[2:, 4].set(1.0), still.at[1:, 0].set(1.0)):
        assert all(bool(jnp.isfinite(x).all()) for x in slopes(points, jnp.asarray(0.1)))
