"""Motion through waypoints: straight where it can be, around where the wall is in the way."""

from types import SimpleNamespace
from typing import cast

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.mapping import Canvas
from jaxpaint.trajectories import sample
from sims.painting.job import Job
from sims.painting.motion import SETTLE, clear_motion, find_ways, motion_duration, motion_rows
from sims.painting.segments import Around, filled, in_blocks
from sims.robots import load_robot


@pytest.fixture(scope="module")
def job():
    """What planning needs of one: the reference robot before a flat wall at x = 0, as its lidar saw it."""
    canvas = Canvas(*map(jnp.asarray, ([0.0, 0.0, 1.2], 0.0, [1.2, 0.8])))
    echoes = jnp.stack([jnp.zeros(541), jnp.linspace(-4.0, 4.0, 541)], axis=-1)
    return cast(Job, SimpleNamespace(robot=load_robot(), canvas=canvas, echoes=echoes, dt=jnp.asarray(0.02)))


@pytest.fixture(scope="module")
def waypoints(job):
    """In the first world free in the room; in the second to a posture that a panel stands before."""
    home = np.asarray(job.robot.at_home(jnp.array([-1.6, 0.0, 0.0])))
    rows = np.stack([home] * 3)
    rows[1, 3] += 0.4
    rows[2, :3] = [-1.6, 0.4, 0.2]
    behind = rows.copy()
    behind[1] = home
    behind[2] = home
    behind[2, :2] = [-1.6, 1.4]
    return np.stack([rows, behind]).astype(np.float32)


@pytest.fixture(scope="module")
def panel():
    """A board that stands out of the wall between the ends of the second world's way."""
    x, z = np.meshgrid(np.arange(-0.95, 0.0, 0.03), np.arange(0.6, 2.0, 0.03))
    return np.stack([x.ravel(), 0 * x.ravel() + 0.7, z.ravel()], -1)


@pytest.fixture(scope="module")
def motion(job, waypoints, panel):
    nothing = np.full_like(panel, np.nan)
    return clear_motion(job, jnp.asarray(waypoints), jnp.asarray(np.stack([nothing, panel]), jnp.float32))


ROWS = 2000
SAMPLE, SAMPLES = jax.jit(sample), jax.jit(lambda t, dt: motion_rows(t, dt, ROWS))


def test_it_rests_at_the_waypoints_in_both_worlds(job, waypoints, motion):
    for world in range(2):
        one = jax.tree.map(lambda x, w=world: jnp.asarray(x)[w], motion.trajectory)
        for k, arrival in enumerate(np.asarray(motion.arrival)[world]):
            state = SAMPLE(one, jnp.asarray(arrival + SETTLE / 2))
            np.testing.assert_allclose(state.p, waypoints[world, k], atol=1e-4)
            np.testing.assert_allclose(state.v, 0, atol=1e-6)
        assert float(motion_duration(one)) < ROWS * float(job.dt)
        rows = np.asarray(SAMPLES(one, job.dt))
        np.testing.assert_allclose(rows[-1, :9], waypoints[world, -1], atol=1e-4)
        step = np.diff(rows[:, :9], axis=0) / float(job.dt)
        np.testing.assert_allclose(step, (rows[1:, 9:] + rows[:-1, 9:]) / 2, atol=0.02)


def test_only_the_way_that_is_barred_is_bent(motion):
    segments = np.asarray(motion.trajectory.segments).reshape(2, 2, 3) > 0
    # a segment's way to its first via point, to its second, and from there
    assert not segments[0, :, :2].any() and segments[0, :, 2].all()
    assert segments[1, 1].all()
    assert (np.asarray(motion.gap) > 0.02).all()


def test_a_goal_inside_a_board_is_known_to_touch(job, waypoints, panel):
    """Its gap is below zero whatever the way, which makes a mission unreachable."""
    inside = waypoints[1, [0, 2]].copy()
    inside[1, :2] = [-0.9, 0.7]
    found = find_ways(Around.of(job), inside[None], panel[None].astype(np.float32))
    assert found.gap.min() < 0
    np.testing.assert_allclose(found.ends[0, [0, -1], [0, 1]], inside, atol=1e-6)
    np.testing.assert_allclose(found.ends[0, 1:, 0], found.ends[0, :-1, 1], atol=1e-6)


def test_the_chassis_is_seen_between_the_points_that_stand_for_it(job):
    """A thin post in its front, as scanned points from the floor up. By the base's rectangle alone the gap is
    exact; its spheres stick out a little.
    """
    q = np.asarray(job.robot.at_home(jnp.array([-2.0, 0.0, 0.0])))
    front = float(job.robot.footprint[:, 0].max())
    heights = np.arange(0.0, 0.4, 0.02)
    post = np.stack([0 * heights - 2.0 + front - 0.05, 0 * heights + 0.1, heights], -1)
    around = Around.of(job)
    bare = eqx.tree_at(lambda a: a.robot.spheres.radius, around, around.robot.spheres.radius - 10)
    gaps = [
        find_ways(a, np.stack([q, q])[None], post[None].astype(np.float32)).at_ends[0, -1].min()
        for a in (bare, around)
    ]
    assert gaps[0] == pytest.approx(-0.05, abs=1e-3)
    assert gaps[0] - 0.01 < gaps[1] <= gaps[0]


def test_blocks_give_back_as_many_rows_as_came():
    taken = []

    def program(scale, rows):
        taken.append(len(rows))
        return scale * rows

    rows = np.arange(70.0)
    np.testing.assert_allclose(in_blocks(program, (2.0,), (rows,)), 2 * rows)
    assert len(set(taken)) == 1
    more = filled(np.zeros((2, 5, 3)))
    assert more.shape[1] % 64 == 0 and np.isfinite(more).all(-1).sum() == 10
