"""Inverse kinematics: reaches what can be reached, keeps the limits, and says so where it fails."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.compiling import batched
from jaxpaint.kinematics import IKSettings, Pose, forward, solve, spread_starts
from sims.robots import load_robot

CASES = 16  # every test solves for as many, so that there is one compilation


@pytest.fixture(scope="module")
def robot():
    return load_robot()


@pytest.fixture(scope="module")
def solver(robot):
    """One brush pose from four starts, the base at (x, y, yaw); also the pose that was reached."""

    def one(q_base, target, spin_weight, lower, upper, tolerance):
        starts = spread_starts(robot.home, lower, upper, count=4)
        settings = IKSettings(spin_weight=spin_weight, position_tolerance=tolerance)
        solution = solve(robot.arm(q_base), starts, target, lower, upper, settings)
        return solution, forward(robot.arm(q_base), solution.q)

    return batched(one, in_axes=(0, 0, None, None, None, None), chunk=CASES // 2)


@pytest.fixture(scope="module")
def find(robot, solver):
    def many(q_base, target, spin_weight=1.0, lower=robot.lower, upper=robot.upper, tolerance=1e-4):
        return solver(
            q_base, target, *(jnp.asarray(x, jnp.float32) for x in (spin_weight, lower, upper, tolerance))
        )

    return many


@pytest.fixture(scope="module")
def brush(robot):
    """Brush poses of many postures."""
    return jax.jit(jax.vmap(lambda q_base, q: forward(robot.arm(q_base), q)))


@pytest.fixture(scope="module")
def at_origin():
    return np.zeros((CASES, 3), np.float32)


@pytest.fixture(scope="module")
def near_home(robot):
    """Postures around home, the first of them home itself."""
    away = np.random.default_rng(0).uniform(-0.8, 0.8, (CASES, 6)).astype(np.float32)
    away[0] = 0
    return robot.home + away


def test_poses_that_the_arm_took_are_found_again(find, brush, near_home):
    q_base = np.random.default_rng(1).uniform(-3, 3, (CASES, 3)).astype(np.float32)
    target = brush(q_base, near_home)
    solution, reached = find(q_base, target)
    assert bool(solution.converged.all())
    distance = np.linalg.norm(reached.p - target.p, axis=-1)
    np.testing.assert_allclose(distance, solution.position_error, atol=2e-5)
    assert distance.max() < 2e-4
    np.testing.assert_allclose(reached.R, target.R, atol=2e-3)


def test_the_turn_about_the_brush_is_free_when_it_has_no_weight(robot, find, brush, at_origin, near_home):
    """Poses turned about the brush by a right angle."""
    target = brush(at_origin, near_home)
    quarter = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]], np.float32)
    turned = Pose(target.p, jnp.asarray(np.asarray(target.R) @ quarter))
    free, reached = find(at_origin, turned, spin_weight=0.0)
    assert bool(free.converged.all())
    np.testing.assert_allclose(free.q[0], robot.home, atol=1e-3)  # no change of posture is needed
    np.testing.assert_allclose(reached.R[..., 2], turned.R[..., 2], atol=2e-3)
    whole, reached = find(at_origin, turned)
    assert float(np.abs(whole.q[0] - robot.home).max()) > 1.5
    np.testing.assert_allclose(reached.R[0], turned.R[0], atol=2e-3)


def test_the_solution_next_to_home_is_taken(robot, find, brush, at_origin, near_home):
    """Eight postures reach a pose near home; the one of home's kind wins."""
    q = robot.home + (near_home - robot.home) / 16
    solution, _ = find(at_origin, brush(at_origin, q))
    np.testing.assert_allclose(solution.q, q, atol=5e-3)


def test_out_of_reach_and_not_a_number_are_said(robot, find, brush, at_origin, near_home):
    target = brush(at_origin, near_home)
    offset = np.zeros((CASES, 3), np.float32)
    offset[1], offset[2] = [2.0, 0, 0], np.nan
    solution, _ = find(at_origin, Pose(target.p + offset, target.R))
    assert solution.converged.tolist() == [True, False, False, *[True] * (CASES - 3)]
    assert 1.0 < float(solution.position_error[1]) < 3.0
    assert bool((solution.q[1] >= robot.lower).all() & (solution.q[1] <= robot.upper).all())


def test_limits_hold_even_where_they_forbid_the_pose(robot, find, brush, at_origin, near_home):
    """With the elbow held near home, a pose that needs it bent further is missed, not reached by force."""
    bent = near_home.at[0, 2].add(0.9)
    lower, upper = robot.lower.at[2].set(robot.home[2] - 0.1), robot.upper.at[2].set(robot.home[2] + 0.1)
    solution, _ = find(at_origin, brush(at_origin, bent), lower=lower, upper=upper)
    assert bool((solution.q >= lower).all() & (solution.q <= upper).all())
    assert not bool(solution.converged[0])
    assert bool(find(at_origin, brush(at_origin, bent))[0].converged[0])


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


def test_limits_weights_and_tolerances_do_not_compile_again(solver, find, brush, at_origin, near_home):
    target = brush(at_origin, near_home)
    find(at_origin, target)
    traces = solver.traces
    assert not bool(find(at_origin, target, spin_weight=0.5, tolerance=-1.0)[0].converged.any())
    assert solver.traces == traces
