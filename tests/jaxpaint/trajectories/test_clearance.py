"""Clearance of a moving robot: against a wall whose distance is known."""

import jax
import jax.numpy as jnp
import numpy as np

from jaxpaint.trajectories import clearance
from sims.robots import load_robot


def test_a_robot_that_drives_at_a_wall_loses_as_much_clearance_as_it_drives():
    robot = load_robot()
    steps = np.linspace(0, 0.5, 6)
    q = np.stack([np.asarray(robot.at_home(jnp.array([x, 0, 0]))) for x in steps])

    @jax.jit
    def gaps(wall):
        return clearance(robot.chain, robot.spheres, jnp.asarray(q), lambda p: wall - p[0])

    near = np.asarray(gaps(0.85))  # the wall that the brush touches at home
    np.testing.assert_allclose(near - near[0], -steps, atol=1e-5)
    assert 0.05 < near[0] < 0.15  # the camera is what is nearest then
    assert near[-1] < 0


def test_the_nearest_part_decides():
    """A wall to the left is nearest to the chassis, a ceiling to the elbow."""
    robot = load_robot()
    q = robot.at_home(jnp.zeros(3))[None]
    left = jax.jit(lambda: clearance(robot.chain, robot.spheres, q, lambda p: 1.0 - p[1]))()
    np.testing.assert_allclose(left, 1.0 - 0.30, atol=1e-5)
    above = jax.jit(lambda: clearance(robot.chain, robot.spheres, q, lambda p: 2.0 - p[2]))()
    assert 0.5 < float(above[0]) < 0.9
