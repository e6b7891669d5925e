"""Ways around: a bar in the way of the straight motion, and the gap between two moments."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.kinematics import forward, sphere_centers
from jaxpaint.trajectories import Obstacles, choose, detours, gap_on_the_way
from jaxpaint.trajectories.clearance import sphere_centers_along
from jaxpaint.trajectories.detours import RETREATS, TOGETHER
from sims.robots import load_robot


@pytest.fixture(scope="module")
def robot():
    return load_robot()


def test_points_and_sticks_have_the_distances_of_segments():
    around = Obstacles.points(jnp.array([[1.0, 0, 1], [jnp.nan, 0, 0]])) + Obstacles.sticks(
        jnp.array([[0.0, 2], [jnp.nan, 0]]), jnp.array([0.5, 0.5])
    )
    at = jax.jit(lambda p: around.distance(p))
    assert float(at(jnp.array([1.0, 0, 1.3]))) == pytest.approx(0.3)
    assert float(at(jnp.array([0.0, 1.9, 0.2]))) == pytest.approx(0.1)
    assert float(at(jnp.array([0.0, 2.0, 0.9]))) == pytest.approx(0.4)


def test_the_loop_along_the_chain_agrees_with_the_kinematics(robot):
    q = np.random.default_rng(0).uniform(-2, 2, (5, 9)).astype(np.float32)
    found = jax.jit(sphere_centers_along)(robot.chain, robot.spheres, q)
    wanted = jax.jit(jax.vmap(lambda row: sphere_centers(robot.chain, robot.spheres, row)))(q)
    np.testing.assert_allclose(found, wanted, atol=1e-5)


def test_the_bound_sees_what_lies_between_two_moments(robot):
    """A thin post between two poses of the base that are both clear of it."""
    home = np.asarray(robot.at_home(jnp.zeros(3)))
    q = np.stack([home, home])
    q[1, 1] = 4.0
    post = Obstacles.sticks(jnp.array([[0.0, 2.0]]), jnp.array([1.0]))
    gap = jax.jit(lambda q: gap_on_the_way(robot.chain, robot.spheres, q, post.distance))
    assert min(float(gap(q[:1])), float(gap(q[1:]))) > 1
    assert float(gap(q)) < 0
    fine = np.linspace(q[0], q[1], 60)
    assert float(gap(fine[:20])) > 0.3 and float(gap(fine)) < 1e-3


def test_retreats_draw_the_tool_back_along_its_axis_and_the_base_with_it(robot):
    start = np.asarray(robot.at_home(jnp.zeros(3)))
    goal = np.asarray(robot.at_home(jnp.array([0.0, 0.5, 0.2])))
    ways = np.asarray(jax.jit(detours)(robot.chain, start, goal, robot.lower, robot.upper))
    np.testing.assert_allclose(ways[0], [start, goal])
    pose = jax.jit(forward)
    for end, q in enumerate((start, goal)):
        here = pose(robot.chain, q)
        for way, (tool, base) in zip(ways[: len(RETREATS)], RETREATS, strict=True):
            if tool > 0.3:
                continue  # further than the folded arm can go
            there = pose(robot.chain, way[end])
            np.testing.assert_allclose(there.p, here.p - (tool + base) * here.R[:, 2], atol=0.02)
            np.testing.assert_allclose(there.R[:, 2], here.R[:, 2], atol=0.02)
            assert np.linalg.norm(way[end, :2] - q[:2]) == pytest.approx(base, abs=1e-3)
    # and the ways that the base goes together at both ends
    for way, (_, base) in zip(ways[len(RETREATS) :], TOGETHER, strict=True):
        np.testing.assert_allclose(way[0, :2] - start[:2], way[1, :2] - goal[:2], atol=1e-6)
        assert np.linalg.norm(way[0, :2] - start[:2]) == pytest.approx(base, abs=1e-3)


def test_the_first_way_that_is_clear_is_taken_and_no_more_are_asked():
    start, goal = jnp.zeros(2), jnp.ones(2)
    ways = jnp.arange(5.0)[:, None, None] * jnp.ones((5, 2, 2))
    asked = []

    def run(gaps, margin):
        def gap(rows):
            jax.debug.callback(lambda k: asked.append(int(k)), rows[1, 0])
            return gaps[rows[1, 0].astype(int)]

        return jax.jit(lambda: choose(start, goal, ways, gap, jnp.asarray(margin)))()

    vias, bent, gap = run(jnp.array([-0.1, 0.01, 0.2, 0.3, 0.4]), 0.1)
    jax.effects_barrier()
    assert float(vias[0, 0]) == 2 and bool(bent) and float(gap) == pytest.approx(0.2)
    assert asked == [0, 1, 2]
    vias, bent, _ = run(jnp.array([0.2, 0.3, 0.4, 0.5, 0.6]), 0.1)
    assert float(vias[0, 0]) == 0 and not bool(bent)
    vias, bent, gap = run(jnp.array([-0.5, -0.2, -0.3, jnp.nan, -0.4]), 0.1)
    assert float(vias[0, 0]) == 1 and bool(bent) and float(gap) == pytest.approx(-0.2)
