"""The check of clearances: what touches between two moments, behind a face, with the brush, or itself."""

import numpy as np
import pytest

from experiments.motion.clearance import distances
from experiments.motion.truth import BODY, BRUSH, ITSELF, NEAR, Truth
from sims.robots import load_robot
from sims.scenes import make_wall


@pytest.fixture(scope="module")
def robot():
    return load_robot()


@pytest.fixture(scope="module")
def flat(robot):
    return Truth(make_wall("flat"), robot)


def at(robot, x, y=0.0, arm=0.0):
    return np.concatenate([[x, y, 0], np.asarray(robot.home, float) + arm])


def way(a, b, count=401):
    return a + np.linspace(0, 1, count)[:, None] * (b - a)


def clear(truth, q, brush=True):
    return distances(truth, q, np.full(len(q), brush))


def test_a_flat_wall_is_as_far_as_it_is(robot, flat):
    """The front wheels reach 0.38 m ahead of the middle of the base, and the wall is at x = 0."""
    tucked = at(robot, 0, arm=np.array([np.pi, 0, 0, 0, 0, 0]))
    for gap in (0.04, 0.01, -0.01):
        assert flat.posture(tucked - [0.38 + gap, 0, 0, *[0] * 6]).distance[BODY] == pytest.approx(
            gap, abs=2e-3
        )
    assert flat.posture(at(robot, -3)).distance[BODY] == NEAR


def test_a_robot_wholly_behind_the_face_is_no_clear_one(robot, flat):
    assert flat.posture(at(robot, 0.5)).distance[BODY] < 0


def test_the_brush_counts_where_it_is_asked_for(robot, flat):
    touching = next(
        x for x in np.arange(-1.2, -0.6, 0.005) if flat.posture(at(robot, x)).distance[BRUSH] < -0.02
    )
    q = way(at(robot, -1.5), at(robot, touching))
    assert clear(flat, q)[BRUSH] < -0.02
    assert clear(flat, q, brush=False)[BRUSH] == np.inf and clear(flat, q, brush=False)[BODY] > 0


def test_links_that_go_through_each_other_are_seen(robot, flat):
    """The tool through the forearm; both ends are clear, and so is home."""
    a = np.array([-3, 0, 0, -0.24, -0.96, 1.96, 2.14, -1.34, 0.0])
    b = np.array([-3, 0, 0, 0.86, -2.69, 1.65, 1.12, -4.40, -3.39])
    assert min(flat.posture(q).distance[ITSELF] for q in (a, b, at(robot, -3))) > 0
    assert clear(flat, way(a, b))[ITSELF] < -0.03


def test_a_thin_thing_between_two_rows_is_seen(robot):
    """The post before the wall `objects`, 9 cm across, passed by the brush from one row to the next."""
    truth = Truth(make_wall("objects"), robot)
    low = np.array([0, 0.25, 0, -0.25, 0, 0])
    rows = np.stack([at(robot, -0.93, y, low) for y in (-1.3, -0.9, -0.5)])
    first, middle, last = (truth.posture(q).distance[BRUSH] for q in rows)
    assert middle < 0 and min(first, last) == NEAR
    assert clear(truth, rows[[0, 2]])[BRUSH] <= 0


def test_the_bound_is_close_to_the_least_distance(robot, flat):
    q = way(at(robot, -2), at(robot, -2, arm=np.array([0.5, 0, 0, 0, 0, 0])))
    q = np.concatenate([q, way(q[-1], at(robot, -1.15))])
    seen = min(flat.posture(row).distance.min() for row in q)
    assert seen / 2 <= clear(flat, q).min() <= seen
