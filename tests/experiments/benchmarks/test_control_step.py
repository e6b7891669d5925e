import jax
import jax.numpy as jnp
import numpy as np
import pytest

pytest.importorskip("daqp", reason="needs the extra `bench`")

import daqp

from experiments.benchmarks.control_step import ControlSteps, control_step
from experiments.benchmarks.serial_loop_peer import circle_twist
from jaxpaint.kinematics import frames, tool_jacobian
from sims.driver import at_rest
from sims.limits import robot_limits
from sims.robots import load_robot


@pytest.fixture(scope="module")
def robot():
    return robot_limits(load_robot(), clearance=False)


def test_a_step_does_the_peers_job(robot):
    base, arm = jnp.asarray([0.3, -0.2, 0.4]), jnp.asarray(load_robot().home) + 0.05
    twist = circle_twist(7)
    wheels = at_rest(jnp.zeros(robot.drive.size))
    _, after, _, solved = jax.jit(control_step)(robot, jnp.asarray(twist, float), base, arm, wheels)
    _, jacobian = tool_jacobian(robot.chain, frames(robot.chain, robot.joints(base, arm)))
    rows = np.asarray(jacobian, float)
    above, below = np.r_[np.full(9, 1.0), twist], np.r_[np.full(9, -1.0), twist]
    sense = np.array([0] * 9 + [5] * 6, dtype=np.int32)
    expected = daqp.solve(0.01 * np.eye(9), np.zeros(9), rows, above, below, sense)[0]
    assert bool(solved)
    np.testing.assert_allclose((after - arm) / 0.02, expected[3:], atol=2e-4)


def test_all_programs_are_solved_and_odometry_goes_on():
    steps = ControlSteps(worlds=4, steps=20)
    base, arm, unsolved = steps._run(*steps._inputs)
    _, _, first, start = steps._inputs
    assert not np.asarray(unsolved).any()
    travel = np.linalg.norm((np.asarray(base) - np.asarray(first))[:, :2], axis=1)
    assert (travel > 1e-4).all() and (travel < 0.05).all()
    assert np.abs(np.asarray(arm) - np.asarray(start)).max() <= 20 * 0.02 + 1e-5
