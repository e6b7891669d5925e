"""One painting run from scan to score: small worlds, every stage."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
import pytest

from experiments.commands.paint_options import PaintOptions
from experiments.paint import score
from experiments.paint_job import paint_task
from jaxpaint.errors import InputError
from jaxpaint.steering import differential
from sims.painting import run_mission
from sims.painting.drive import _BLOCKS, BrushPlan
from sims.status import Status

WORLDS = 4  # of the fixtures


def test_all_worlds_are_painted(task, mission):
    rows = score(task, mission)
    assert [row.status for row in rows] == ["ok"] * WORLDS
    for row in rows:
        assert row.coverage > 0.95
        assert row.excess < 0.05
        assert 0 < row.rmse_total < 0.01
        assert 0 < row.normal_error_mean_deg < 3
        assert row.stroke_error_mean < 0.004
    assert len({row.rmse_total for row in rows}) == WORLDS  # the worlds differ


def test_each_controller_does_what_it_is_for(mission):
    assert not mission.modes.scan.any()
    assert mission.modes.paint.all()


def test_a_broken_world_is_counted_and_changes_no_other(task, mission):
    def break_one(worlds):
        return eqx.tree_at(lambda w: w.odometry, worlds, jnp.asarray(worlds.odometry).at[2].set(jnp.nan))

    broken = run_mission(task.job, task.grid, np.arange(WORLDS), disturb=break_one)
    assert broken.status[2] == Status.DIVERGED
    kept = [0, 1, 3]
    np.testing.assert_array_equal(broken.status[kept], Status.OK)
    films = (np.asarray(m.laid.thickness)[kept] for m in (mission, broken))
    np.testing.assert_array_equal(*films)
    live = mission.driven.record.live[kept]
    rows = live.shape[1]
    ours, theirs = mission.truth.position[kept][live], broken.truth.position[kept][:, :rows][live]
    np.testing.assert_array_equal(ours, theirs)


def test_a_world_does_not_depend_on_how_many_run_and_sweeps_do_not_trace_again(task, mission):
    traces = _BLOCKS[BrushPlan].traces
    job = eqx.tree_at(
        lambda j: (j.thresholds.halt_travel, j.settings.position_gain),
        task.job,
        (jnp.float32(0.2), jnp.float32(3.0)),
    )
    run_mission(job, task.grid, np.arange(WORLDS))
    assert _BLOCKS[BrushPlan].traces == traces
    more = run_mission(task.job, task.grid, np.arange(WORLDS + 2))
    np.testing.assert_array_equal(np.asarray(more.laid.thickness)[:WORLDS], mission.laid.thickness)
    np.testing.assert_array_equal(np.asarray(more.laid.tracking.total)[:WORLDS], mission.laid.tracking.total)


def test_a_differential_base_is_refused_before_it_moves(task):
    """Its plans would go sideways, whoever follows them."""
    two = differential(jnp.float32(0.5), jnp.float32(0.0), jnp.float32(1.2))
    job = eqx.tree_at(lambda j: (j.robot.drive, j.limits.drive), task.job, (two, two))
    with pytest.raises(InputError, match=r"differential base.*allowed"):
        run_mission(job, task.grid, np.arange(1))


def test_a_canvas_out_of_reach_is_unreachable_not_an_error(two_strokes):
    pose = (-0.05, 0.0, 2.5, 0.0)
    high = paint_task(
        PaintOptions(image=two_strokes, canvas_size=(0.5, 0.5), canvas_pose=pose, worlds=WORLDS)
    )
    mission = run_mission(high.job, high.grid, np.arange(WORLDS))
    np.testing.assert_array_equal(mission.status, Status.UNREACHABLE)


@pytest.mark.slow
@pytest.mark.parametrize("controller", ["trajectory", "whole-body"])
def test_a_forced_controller_moves_everything(task, controller):
    mission = run_mission(task.job, task.grid, np.arange(2), controller=controller)
    assert mission.modes.scan.all() == mission.modes.paint.all() == (controller == "whole-body")
    np.testing.assert_array_equal(mission.status, Status.OK)
