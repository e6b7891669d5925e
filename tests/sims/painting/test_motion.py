"""Motion through waypoints: straight where it can be, around where the wall is in the way."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from experiments.commands.paint_options import PaintOptions
from experiments.paint_job import paint_task
from jaxpaint.trajectories import sample
from sims.painting.motion import SETTLE, clear_motion, motion_duration, motion_rows


@pytest.fixture(scope="module")
def job():
    return paint_task(PaintOptions(worlds=2)).job


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
    x, z = np.meshgrid(np.arange(-0.95, 0.0, 0.06), np.arange(0.6, 2.0, 0.06))
    return np.stack([x.ravel(), 0 * x.ravel() + 0.7, z.ravel()], -1)


@pytest.fixture(scope="module")
def motion(job, waypoints, panel):
    nothing = np.full_like(panel, np.nan)
    return clear_motion(job, jnp.asarray(waypoints), jnp.asarray(np.stack([nothing, panel]), jnp.float32))


def test_it_rests_at_the_waypoints_in_both_worlds(job, waypoints, motion):
    for world in range(2):
        one = jax.tree.map(lambda x, w=world: jnp.asarray(x)[w], motion.trajectory)
        for k, arrival in enumerate(np.asarray(motion.arrival)[world]):
            state = sample(one, jnp.asarray(arrival + SETTLE / 2))
            np.testing.assert_allclose(state.p, waypoints[world, k], atol=1e-4)
            np.testing.assert_allclose(state.v, 0, atol=1e-6)
        rows = np.asarray(motion_rows(one, job.dt, int(float(motion_duration(one)) / float(job.dt)) + 50))
        np.testing.assert_allclose(rows[-1, :9], waypoints[world, -1], atol=1e-4)
        step = np.diff(rows[:, :9], axis=0) / float(job.dt)
        np.testing.assert_allclose(step, (rows[1:, 9:] + rows[:-1, 9:]) / 2, atol=0.02)


def test_only_the_way_that_is_barred_is_bent(motion):
    segments = np.asarray(motion.trajectory.segments).reshape(2, 2, 3) > 0
    # a segment's way to its first via point, to its second, and from there
    assert not segments[0, :, :2].any() and segments[0, :, 2].all()
    assert segments[1, 1].all()
    assert (np.asarray(motion.gap) > 0.02).all()
