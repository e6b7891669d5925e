"""Park, operate, park: the base moves only while the pen is up, and the plan waits for it."""

import dataclasses

import equinox as eqx
import jax.numpy as jnp
import numpy as np
import pytest

from experiments.tracking import follow, parked, study_of
from sims.painting.drive import drive
from sims.painting.job import PAINT

REACH = 0.25
# As the other tests of tracking have: they share compiled programs.
WORLDS = 8


@pytest.fixture(scope="module")
def study():
    """A line of 1.1 m, which is three places of the base."""
    u = np.linspace(-0.55, 0.55, 400)
    return study_of(np.stack([u, 0 * u], axis=1), noise="none")


def test_the_cut_plan_is_the_same_curve_with_rests(study):
    cut = parked(study, REACH)
    before = study.plan.rows[: int(float(study.plan.duration) / 0.02)]
    after = cut.plan.rows[: int(float(cut.plan.duration) / 0.02)]
    np.testing.assert_allclose(after[-1, :3], before[-1, :3], atol=1e-3)
    way = np.linalg.norm(np.diff(after[:, :3], axis=0), axis=1)
    assert way.sum() == pytest.approx(study.length, rel=1e-3)
    np.testing.assert_allclose(after[1:-1, 12:15], (after[2:, :3] - after[:-2, :3]) / 0.04, atol=2e-3)
    up = after[:, 18] < 0.5
    np.testing.assert_allclose(after[up, 12:18], 0, atol=1e-3)
    assert (np.diff(up.astype(int)) == 1).sum() == len(np.unique(cut.plan.stations, axis=0)) - 1 == 2


def test_the_base_moves_only_while_the_pen_is_up(study):
    cut = parked(study, REACH)
    run, record = _driven(cut)
    moving = np.linalg.norm(np.diff(record.base[0], axis=0), axis=1) > 1e-5
    live = record.live[0][:-1] & record.live[0][1:]
    down = (record.pen[0][:-1] > 0.5) & (record.pen[0][1:] > 0.5)
    settled = np.arange(len(live)) > 25
    assert not (moving & down & live & settled).any()
    assert (moving & ~down & live).sum() > 20
    assert run.completed.all()
    # At most two places with the pen up, each reached in one go.
    assert np.asarray(run.state.memory.halt.halts).max() <= 3


def test_waiting_costs_time_and_the_brush_is_where_it_should_be(study):
    plain, cut = follow(study, WORLDS), follow(parked(study, REACH), WORLDS)
    assert cut.completed.all() and plain.completed.all()
    assert (cut.time > plain.time + 3).all()
    assert cut.score.total.max() < 5e-4


def test_a_base_that_cannot_come_is_given_up(study):
    """One that has no speed: after ten seconds the robot stops waiting, and says so."""
    cut = parked(study, REACH)
    stuck = eqx.tree_at(lambda j: j.settings.base_speed, cut.job, jnp.zeros_like(cut.job.settings.base_speed))
    run, record = _driven(dataclasses.replace(cut, job=stuck))
    assert not run.completed.any()
    assert np.asarray(run.state.gave_up).all()
    assert not (record.pen[:, -1] > 0.5).any()


def _driven(study):
    from experiments.tracking.follow import start_worlds

    index = np.arange(WORLDS, dtype=np.int32)
    plan = type(study.plan)(*(np.repeat(np.asarray(x)[None], WORLDS, axis=0) for x in study.plan))
    run = drive(study.job, plan, start_worlds(study, index), index, PAINT)
    return run, run.record
