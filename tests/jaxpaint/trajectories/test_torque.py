"""Weak motors: no torque beyond the limit, and no slower than need be."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.kinematics import inverse_dynamics
from jaxpaint.trajectories import Limits, plan_base_and_arm, plan_within_torque, sample
from sims.robots import load_robot


@pytest.fixture(scope="module")
def robot():
    return load_robot()


@pytest.fixture(scope="module")
def planned(robot):
    @jax.jit
    def plan(points, torque):
        limits = Limits(robot.speed_limit, robot.acceleration_limit)
        mask = jnp.ones(points.shape[0], bool)
        free = plan_base_and_arm(points, mask, limits, 0.1)
        bound, strong = plan_within_torque(points, mask, limits, 0.1, robot.chain, robot.inertia, torque)

        def torques(trajectory):
            def at(t):
                s = sample(trajectory, t)
                return inverse_dynamics(robot.chain, robot.inertia, s.p, s.v, s.a)

            return jax.vmap(at)(jnp.linspace(0, 1, 800) * trajectory.duration)

        both = jax.tree.map(lambda a, b: jnp.stack([a, b]), free, bound)
        return free, bound, strong, *jax.vmap(torques)(both)

    @jax.jit
    def weights(points):
        between = points[:-1] + jnp.linspace(0, 1, 50)[:, None, None] * (points[1:] - points[:-1])
        rest = jnp.zeros(points.shape[1])
        hold = jax.vmap(lambda q: inverse_dynamics(robot.chain, robot.inertia, q, rest, rest))
        return jnp.abs(hold(between.reshape(-1, points.shape[1]))).max(0)

    def run(points, spare):
        """The plan of motors that have so much more than the weight asks for."""
        limit = weights(jnp.asarray(points)) + jnp.asarray(spare)
        return jax.tree.map(np.asarray, (*plan(jnp.asarray(points), limit), limit))

    return run


def ways(robot):
    home = np.asarray(robot.at_home(jnp.zeros(3)))
    points = np.stack([home, home, home, home])
    points[1, 3:] += [1.5, 0.6, -0.9, 0.8, 0.5, 1.0]
    points[2, :3] += [0.6, -0.2, 0.5]
    points[3] = home
    return points


def test_strong_motors_change_nothing(robot, planned):
    free, bound, strong, _, torque, limit = planned(ways(robot), np.array([2000.0] * 3 + [90] * 3 + [25] * 3))
    np.testing.assert_allclose(bound.segments, free.segments, rtol=1e-5)
    assert (np.abs(torque) <= limit).all() and strong.all()


def test_weak_motors_are_obeyed_and_used(robot, planned):
    """Motors that hold the arm with little to spare."""
    free, bound, strong, before, after, weak = planned(
        ways(robot), np.array([70.0, 70, 30, 8, 6, 4, 1, 1, 1])
    )
    assert (np.abs(before) / weak).max() > 1.3
    assert (np.abs(after) / weak).max() <= 1.001
    assert (np.abs(after) / weak).max() > 0.9 and strong.all()
    longer = bound.segments / free.segments
    assert longer.max() > 1.05 and longer.min() > 1 - 1e-5
    np.testing.assert_allclose(bound.points, free.points)


def test_a_motor_too_weak_for_the_weight_is_told_and_makes_no_plan_that_is_not_finite(robot, planned):
    spare = np.array([90.0, 90, 60, 20, -5, 18, 3, 3, 3])
    _, bound, strong, *_ = planned(ways(robot), spare)
    assert not strong.all()
    assert np.isfinite(bound.segments).all() and bound.segments.max() < 20


def test_a_motor_that_the_weight_takes_nearly_all_of_is_limited_all_the_same(robot, planned):
    """The weight at the shoulder is 98 % of what its motor gives: slow, and within the limit."""
    *_, strong_limit = planned(ways(robot), np.zeros(9))
    spare = np.array([2000.0, 2000, 2000, 90, strong_limit[4] * (1 / 0.98 - 1), 90, 25, 25, 25])
    free, bound, strong, before, after, limit = planned(ways(robot), spare)
    assert strong.all()
    assert (np.abs(before) / limit).max() > 1.05
    assert (np.abs(after) / limit).max() <= 1.001
    assert bound.segments.max() > free.segments.max() and np.isfinite(bound.segments).all()
