"""A robot that touches itself: by spheres of known places, and an arm whose tool goes through its forearm."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.trajectories import own_gap
from sims.robots import load_robot

BEFORE = np.array([0, 0, 0, -0.24, -0.96, 1.96, 2.14, -1.34, 0.0])
AFTER = np.array([0, 0, 0, 0.86, -2.81, 1.77, 1.18, -3.98, -3.14])


@pytest.fixture(scope="module")
def gap():
    robot = load_robot()
    home = robot.at_home(jnp.zeros(3))
    run = jax.jit(lambda q, ends: own_gap(robot.chain, robot.spheres, home, q, ends))

    def padded(q, ends=None):
        ends = np.asarray(home)[None].repeat(2, axis=0) if ends is None else ends
        return float(run(jnp.asarray(np.concatenate([q, np.repeat(q[-1:], 256 - len(q), axis=0)])), ends))

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


def test_what_is_near_at_an_end_may_be_so_near_on_the_way_but_no_nearer(gap):
    """A camera's posture: the tool's cylinders are 1 cm from the forearm's, its spheres 1.6 cm inside."""
    there = np.array([0, 0, 0, -4.59, -0.57, 1.34, 2.37, 3.02, 0])
    assert gap(there[None]) < -0.01
    assert gap(there[None], np.stack([there, there])) == pytest.approx(0.01, abs=1e-4)
    # with the tool turned on towards the forearm it is nearer, and that counts
    deeper = there + np.array([0, 0, 0, 0, 0, 0, 0.6, 0.1, 0])
    ways = [gap(there + np.linspace(0, 1, 100)[:, None] * (x - there), there[None]) for x in (deeper, there)]
    assert ways[0] < ways[1]
    # what is truly inside is known to be so at an end as well
    middle = BEFORE + 0.66 * (AFTER - BEFORE)
    assert gap(middle[None], middle[None]) < -0.02
