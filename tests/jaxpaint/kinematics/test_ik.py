"""Inverse kinematics: reaches what can be reached, keeps the limits, and says so where it fails."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.compiling import batched
from jaxpaint.kinematics import IKSettings, Pose, forward, solve, spread_starts
from sims.robots import load_robot


@pytest.fixture(scope="module")
def robot():
    return load_robot()


@pytest.fixture(scope="module")
def find(robot):
    """Solves for many brush poses at once, from four starts each, the base at (x, y, yaw)."""

    def one(q_base, target, spin_weight):
        starts = spread_starts(robot.home, robot.lower, robot.upper, count=4)
        settings = IKSettings(spin_weight=spin_weight)
        solution = solve(robot.arm(q_base), starts, target, robot.lower, robot.upper, settings)
        return solution, forward(robot.arm(q_base), solution.q)

    return batched(one, in_axes=(0, 0, 0), chunk=16)


@pytest.fixture(scope="module")
def brush(robot):
    """Brush poses of many postures."""
    run = jax.jit(jax.vmap(lambda q_base, q: forward(robot.arm(q_base), q)))
    return lambda q_base, q: run(jnp.asarray(q_base, jnp.float32), jnp.asarray(q, jnp.float32))


def test_poses_that_the_arm_took_are_found_again(robot, find, brush):
    rng = np.random.default_rng(0)
    q_base = rng.uniform(-3, 3, (20, 3)).astype(np.float32)
    target = brush(q_base, robot.home + rng.uniform(-0.8, 0.8, (20, 6)))
    solution, reached = find(q_base, target, np.ones(20, np.float32))
    assert bool(solution.converged.all())
    distance = np.linalg.norm(reached.p - target.p, axis=-1)
    np.testing.assert_allclose(distance, solution.position_error, atol=2e-5)
    assert distance.max() < 2e-4
    np.testing.assert_allclose(reached.R, target.R, atol=2e-3)


def test_the_turn_about_the_brush_is_free_when_it_has_no_weight(robot, find, brush):
    """A pose turned about the brush by a right angle: with no weight on that, no change of posture is needed."""
    home = brush(np.zeros((2, 3)), np.tile(robot.home, (2, 1)))
    quarter = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]], np.float32)
    turned = Pose(home.p, jnp.asarray(np.asarray(home.R) @ quarter))
    solution, reached = find(np.zeros((2, 3), np.float32), turned, np.array([0, 1], np.float32))
    assert bool(solution.converged.all())
    np.testing.assert_allclose(solution.q[0], robot.home, atol=1e-3)
    assert float(np.abs(solution.q[1] - robot.home).max()) > 1.5
    np.testing.assert_allclose(reached.R[1], turned.R[1], atol=2e-3)


def test_the_solution_next_to_home_is_taken(robot, find, brush):
    """Eight postures reach a pose near home; the one of home's kind wins."""
    q = np.asarray(robot.home + 0.05)[None]
    solution, _ = find(np.zeros((1, 3), np.float32), brush(np.zeros((1, 3)), q), np.ones(1, np.float32))
    np.testing.assert_allclose(solution.q, q, atol=5e-3)


def test_out_of_reach_and_not_a_number_are_said(robot, find, brush):
    home = brush(np.zeros((3, 3)), np.tile(robot.home, (3, 1)))
    asked = Pose(home.p + jnp.array([[2.0, 0, 0], [jnp.nan] * 3, [0.05, 0, 0]]), home.R)
    solution, _ = find(np.zeros((3, 3), np.float32), asked, np.ones(3, np.float32))
    assert solution.converged.tolist() == [False, False, True]
    assert 1.0 < float(solution.position_error[0]) < 3.0
    assert bool((solution.q[0] >= robot.lower).all() & (solution.q[0] <= robot.upper).all())


def test_limits_hold_even_where_they_forbid_the_pose(robot, brush):
    """With the elbow held near home, a pose that needs it bent further is missed, not reached by force."""
    wanted = brush(np.zeros((1, 3)), np.asarray(robot.home.at[2].add(0.5))[None])
    lower, upper = robot.lower.at[2].set(robot.home[2] - 0.1), robot.upper.at[2].set(robot.home[2] + 0.1)
    target = Pose(wanted.p[0], wanted.R[0])
    solution = jax.jit(lambda: solve(robot.arm(jnp.zeros(3)), robot.home[None], target, lower, upper))()
    assert bool((solution.q >= lower).all() & (solution.q <= upper).all())
    assert not bool(solution.converged)


def test_base_and_arm_together(robot):
    """The whole chain reaches what the arm alone cannot."""

    @jax.jit
    def reach():
        start = robot.at_home(jnp.zeros(3))
        home = forward(robot.chain, start)
        far = Pose(home.p + jnp.array([2.0, 1.0, 0.2]), home.R)
        wide = jnp.full(3, 10.0)
        lower, upper = jnp.concatenate([-wide, robot.lower]), jnp.concatenate([wide, robot.upper])
        solution = solve(robot.chain, start[None], far, lower, upper, IKSettings(iterations=40))
        return solution, forward(robot.chain, solution.q).p - far.p

    solution, miss = reach()
    assert bool(solution.converged)
    np.testing.assert_allclose(miss, 0, atol=2e-4)


def test_starts_are_spread_within_the_limits(robot):
    starts = np.asarray(spread_starts(robot.home, robot.lower, robot.upper, count=64))
    np.testing.assert_array_equal(starts[0], robot.home)
    assert (starts >= np.asarray(robot.lower)).all() and (starts <= np.asarray(robot.upper)).all()
    # every joint sees every quarter of its range
    low, high = np.maximum(robot.home - np.pi, robot.lower), np.minimum(robot.home + np.pi, robot.upper)
    quarters = np.floor((starts[1:] - low) / (high - low) * 4).clip(0, 3)
    for joint in range(6):
        assert np.bincount(quarters[:, joint].astype(int), minlength=4).min() >= 8


def test_one_compilation_for_all_worlds_and_settings(robot):
    def reach(x, tolerance):
        home = forward(robot.arm(jnp.zeros(3)), robot.home)
        target = Pose(home.p + jnp.stack([x, 0 * x, 0 * x]), home.R)
        settings = IKSettings(position_tolerance=tolerance, iterations=12)
        return solve(robot.arm(jnp.zeros(3)), robot.home[None], target, robot.lower, robot.upper, settings)

    run = batched(reach, in_axes=(0, None), chunk=2)
    near = run(jnp.array([0.0, 0.05, -0.05]), jnp.asarray(1e-4))
    assert bool(near.converged.all())
    assert not bool(run(jnp.array([0.0, 3.0, -0.05]), jnp.asarray(1e-4)).converged.all())
    assert not bool(run(jnp.array([0.02, 0.05, -0.05]), jnp.asarray(-1.0)).converged.any())
    assert run.traces == 1
