"""Clearance of a moving robot: against a wall whose distance is known, points, and posts."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.trajectories import Obstacles, gap_on_the_way
from sims.robots import load_robot


def _rows(q):
    """As many rows always, the last again and again: one program."""
    return jnp.asarray(np.concatenate([q, np.repeat(q[-1:], 60 - len(q), axis=0)]))


@pytest.fixture(scope="module")
def robot():
    return load_robot()


@pytest.fixture(scope="module")
def gap(robot):
    """The gap at rows of joint positions, and between them, to a plane: distance = offset + normal . p."""

    @jax.jit
    def run(q, normal, offset):
        return gap_on_the_way(robot.chain, robot.spheres, q, lambda p: offset + (normal * p).sum())

    return lambda q, normal, offset: float(run(_rows(q), jnp.array(normal, float), offset))


def test_a_robot_that_drives_at_a_wall_loses_as_much_clearance_as_it_drives(robot, gap):
    steps = np.linspace(0, 0.5, 6)
    q = np.stack([np.asarray(robot.at_home(jnp.array([x, 0, 0]))) for x in steps])
    near = np.array([gap(row[None], [-1, 0, 0], 0.85) for row in q])  # the wall the brush touches at home
    np.testing.assert_allclose(near - near[0], -steps, atol=1e-5)
    assert 0.05 < near[0] < 0.15  # the camera is what is nearest then
    assert near[-1] < 0
    # a wall along the way is no nearer between the moments, but for half of what is driven in between
    assert gap(q[0][None], [0, -1, 0], 1.0) - gap(q, [0, -1, 0], 1.0) == pytest.approx(0.05, abs=1e-5)


def test_the_nearest_part_decides(robot, gap):
    """A wall to the left is nearest to the chassis, a ceiling to the elbow.

    The chassis is 12 cells of 0.1875 x 0.2 x 0.2 m, a sphere around each.
    """
    q = np.asarray(robot.at_home(jnp.zeros(3)))[None]
    reach = 0.2 + np.linalg.norm([0.1875, 0.2, 0.2]) / 2
    assert gap(q, [0, -1, 0], 1.0) == pytest.approx(1.0 - reach, abs=1e-5)
    assert 0.5 < gap(q, [0, 0, -1], 2.0) < 0.9


def test_points_and_sticks_have_the_distances_of_segments():
    around = Obstacles.points(jnp.array([[1.0, 0, 1], [jnp.nan, 0, 0]])) + Obstacles.sticks(
        jnp.array([[0.0, 2], [jnp.nan, 0]]), jnp.array([0.5, 0.5])
    )
    at = jax.jit(lambda p: around.distance(p))
    assert float(at(jnp.array([1.0, 0, 1.3]))) == pytest.approx(0.3)
    assert float(at(jnp.array([0.0, 1.9, 0.2]))) == pytest.approx(0.1)
    assert float(at(jnp.array([0.0, 2.0, 0.9]))) == pytest.approx(0.4)


def test_the_bound_sees_what_lies_between_two_moments(robot):
    """A thin post between two poses of the base that are both clear of it."""
    home = np.asarray(robot.at_home(jnp.zeros(3)))
    q = np.stack([home, home])
    q[1, 1] = 4.0
    post = Obstacles.sticks(jnp.array([[0.0, 2.0]]), jnp.array([1.0]))
    run = jax.jit(lambda q: gap_on_the_way(robot.chain, robot.spheres, q, post.distance))

    def gap(q):
        return run(_rows(q))

    assert min(float(gap(q[:1])), float(gap(q[1:]))) > 1
    assert float(gap(q)) < 0
    fine = np.linspace(q[0], q[1], 60)
    assert float(gap(fine[:20])) > 0.3 and float(gap(fine)) < 1e-3
