"""A robot that touches itself: by spheres of known places, and an arm whose tool goes through its forearm."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.trajectories import own_gap, own_gap_at
from sims.robots import load_robot

BEFORE = np.array([0, 0, 0, -0.24, -0.96, 1.96, 2.14, -1.34, 0.0])
AFTER = np.array([0, 0, 0, 0.86, -2.69, 1.65, 1.12, -4.40, -3.39])


@pytest.fixture(scope="module")
def gap():
    robot = load_robot()
    home = robot.at_home(jnp.zeros(3))
    run = jax.jit(lambda q: own_gap(robot.chain, robot.spheres, home, q))

    def padded(q):
        return float(run(jnp.asarray(np.concatenate([q, np.repeat(q[-1:], 256 - len(q), axis=0)]))))

    return padded


def test_at_home_it_is_whole_wherever_the_base_stands(gap):
    home = np.asarray(load_robot().at_home(jnp.zeros(3)))
    there = home + np.array([5.0, -3, 2, 0, 0, 0, 0, 0, 0])
    assert 0.02 < gap(home[None]) < 0.06
    assert gap(there[None]) == pytest.approx(gap(home[None]), abs=1e-5)
    assert gap(np.stack([home, there])) == pytest.approx(gap(home[None]), abs=1e-5)


def test_a_tool_that_passes_through_the_forearm_is_seen_between_moments_that_are_clear(gap):
    way = BEFORE + np.linspace(0, 1, 200)[:, None] * (AFTER - BEFORE)
    assert gap(way[:1]) > 0 and gap(way[-1:]) > 0
    assert gap(way) < -0.03
    assert gap(way[[0, -1]]) < 0


def test_one_posture_has_the_gap_of_a_way_that_stays_there(gap):
    robot = load_robot()
    home = robot.at_home(jnp.zeros(3))
    at = jax.jit(lambda q: own_gap_at(robot.chain, robot.spheres, home, q))
    for q in (BEFORE, AFTER, BEFORE + 0.66 * (AFTER - BEFORE)):
        assert float(at(jnp.asarray(q))) == pytest.approx(gap(q[None]), abs=1e-5)
