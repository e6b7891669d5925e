"""Ways around: where the via points lie."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.compiling import batched
from jaxpaint.kinematics import forward
from jaxpaint.trajectories import WAYS, detours
from sims.robots import load_robot


@pytest.fixture(scope="module")
def robot():
    return load_robot()


@pytest.fixture(scope="module")
def ends(robot):
    """At home and, turned and aside, with the arm a little elsewhere."""
    start = np.asarray(robot.at_home(jnp.zeros(3)))
    goal = np.array(robot.at_home(jnp.array([0.0, 0.5, 0.2])))
    goal[3:] += 0.2
    return start, goal


@pytest.fixture(scope="module")
def ways(robot, ends):
    find = batched(
        lambda r, *ends: detours(r.chain, *ends, r.lower, r.upper, r.home), in_axes=(None, 0, 0), chunk=1
    )
    return np.asarray(find(robot, *(q[None] for q in ends)))[0]


POSE = jax.jit(forward)


def test_the_arm_draws_the_tool_back_along_its_axis_and_the_base_goes_as_far_as_asked(robot, ends, ways):
    drawn = 0
    for way, (tool, base, where, folded) in zip(ways, WAYS, strict=True):
        for q, via in zip(ends, way, strict=True):
            assert np.linalg.norm(via[:2] - q[:2]) == pytest.approx(base, abs=1e-3) and via[2] == q[2]
            if folded or tool > 0.26 or where > 0:
                continue  # further than the folded arm can go, or not along the tool
            here, there = POSE(robot.chain, q), POSE(robot.chain, via)
            level = np.array([here.R[0, 2], here.R[1, 2], 0])
            wanted = here.p - tool * here.R[:, 2] - base * level / np.linalg.norm(level)
            np.testing.assert_allclose(there.p, wanted, atol=0.02)
            np.testing.assert_allclose(there.R[:, 2], here.R[:, 2], atol=0.03)
            drawn += tool > 0
    assert drawn >= 6


def test_both_ends_go_the_same_way_or_each_straight_back(ends, ways):
    for where in (1, 2):
        chosen = ways[(WAYS[:, 2] == where) & (WAYS[:, 1] > 0)]
        assert len(chosen)
        for way in chosen:
            step = [via[:2] - q[:2] for via, q in zip(way, ends, strict=True)]
            if where == 1:
                np.testing.assert_allclose(step[0], step[1], atol=1e-6)
            else:
                for q, one in zip(ends, step, strict=True):
                    heading = np.array([np.cos(q[2]), np.sin(q[2])])
                    np.testing.assert_allclose(one, -np.linalg.norm(one) * heading, atol=1e-6)


def test_an_arm_that_is_folded_is_at_home_and_one_that_is_not_asked_stays(robot, ends, ways):
    for way, (tool, _, _, folded) in zip(ways, WAYS, strict=True):
        for q, via in zip(ends, way, strict=True):
            if folded == 1 or (folded == 0 and tool == 0):
                np.testing.assert_allclose(via[3:], robot.home if folded else q[3:], atol=1e-6)


@pytest.mark.parametrize(("what", "at_start"), [(2, "goal"), (3, "start"), (4, "home")])
def test_the_wrist_moves_apart_from_the_rest_of_the_arm(robot, ends, ways, what, at_start):
    """At both via points it is the same, and the rest of the arm is as at the end nearby."""
    wrists = {"start": ends[0][6:], "goal": ends[1][6:], "home": robot.home[3:]}
    chosen = ways[WAYS[:, 3] == what]
    assert len(chosen) == 3
    for way in chosen:
        for q, via in zip(ends, way, strict=True):
            np.testing.assert_allclose(via[6:], wrists[at_start], atol=1e-6)
            np.testing.assert_allclose(via[3:6], q[3:6], atol=1e-6)


def test_the_last_ways_go_by_postures_within_the_limits_all_different(robot, ways):
    arms = ways[WAYS[:, 3] >= 5][..., 3:]
    np.testing.assert_array_equal(arms[:, 0], arms[:, 1])
    assert (arms >= np.asarray(robot.lower)).all() and (arms <= np.asarray(robot.upper)).all()
    assert len(np.unique(arms[:, 0].round(3), axis=0)) == len(arms) > 8
