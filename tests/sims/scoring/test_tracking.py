"""Tracking scores of logs with known errors, and the verdict."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from sims.scoring import Log, Tally, accumulate, judge, tracking_score
from sims.status import Status

STEPS = 200
ACCUMULATE = jax.jit(accumulate)
SCORE = jax.jit(tracking_score)


def log(**changes):
    """A brush that follows its plan along a flat wall, from a base that drives 1.99 m."""
    t = np.linspace(0, 1, STEPS)
    path = np.stack([0 * t, 1 - 2 * t, 1 + 0.1 * np.sin(9 * t)], axis=-1)
    base = np.stack([0 * t - 1, 1 - 1.99 * t, 0 * t], axis=-1)
    parts = {
        "planned": path,
        "brush": path,
        "axis": np.tile([1.0, 0, 0], (STEPS, 1)),
        "pen": np.ones(STEPS),
        "live": np.ones(STEPS, bool),
        "odometry": base,
        "base": base,
        "halted": np.zeros(STEPS, bool),
    }
    return Log(**{name: jnp.asarray(value) for name, value in (parts | changes).items()})


def scored(record, chart):
    return SCORE(ACCUMULATE(Tally.zero(), record, chart))


def verdict(score, completed=True, unreachable=False, infeasible=False):
    flags = {"completed": completed, "unreachable": unreachable, "infeasible": infeasible}
    return Status(int(judge(score, **{name: jnp.asarray(flag) for name, flag in flags.items()})))


def test_perfect_run(plane):
    score = scored(log(), plane().chart)
    for figure in (score.rmse, score.total, score.largest, score.normal_mean, score.drift_largest):
        np.testing.assert_array_equal(figure, 0)
    assert score.travel == pytest.approx(1.99, rel=1e-4)
    assert (int(score.steps), int(score.down), int(score.halts)) == (STEPS, STEPS, 0)
    assert verdict(score) is Status.OK


def test_errors_by_axis_with_the_pen_down_only(plane):
    rng = np.random.default_rng(0)
    error = rng.normal(size=(STEPS, 3)) * [0.001, 0.004, 0.01]
    pen = np.arange(STEPS) % 4 != 0
    record = log(brush=np.asarray(log().planned) + np.where(pen[:, None], error, 1), pen=pen.astype(float))
    score, down = scored(record, plane().chart), error[pen]
    np.testing.assert_allclose(score.rmse, np.sqrt((down**2).mean(0)), rtol=1e-4)
    distance = np.linalg.norm(down, axis=1)
    assert score.total == pytest.approx(np.sqrt((distance**2).mean()), rel=1e-4)
    assert score.largest == pytest.approx(distance.max(), rel=1e-4)
    assert score.p95 == pytest.approx(np.sort(distance)[int(np.ceil(0.95 * len(distance))) - 1], abs=1.01e-4)


def test_normal_error_on_a_curved_wall(pillar):
    t = np.linspace(-0.4, 0.4, STEPS)
    brush = np.asarray(jax.vmap(pillar.chart.point)(jnp.asarray(np.stack([t, t + 1], axis=-1))))
    inward = -np.asarray(jax.vmap(pillar.chart.normal)(jnp.asarray(np.stack([t, t + 1], axis=-1))))
    tilts = np.radians(np.linspace(0, 4, STEPS))[:, None]
    axis = np.cos(tilts) * inward + np.sin(tilts) * [0, 0, 1]
    score = scored(log(brush=brush, planned=brush, axis=axis), pillar.chart)
    assert np.degrees(score.normal_mean) == pytest.approx(2, abs=0.01)
    assert np.degrees(score.normal_p95) == pytest.approx(3.8, abs=0.05)


def test_drift_halts_and_travel(plane):
    base = np.asarray(log().base)
    halted = np.zeros(STEPS, bool)
    halted[[10, 11, 12, 50, 51, 199]] = True
    record = log(odometry=base + np.linspace(0, 0.03, STEPS)[:, None] * [0.6, 0.8, 5], halted=halted)
    score = scored(record, plane().chart)
    assert score.drift_mean == pytest.approx(0.015, rel=1e-3)
    assert score.drift_largest == pytest.approx(0.03, rel=1e-3)
    assert int(score.halts) == 3


@pytest.mark.parametrize("cut", [1, 51, 130])
def test_run_in_parts_is_the_run(plane, cut):
    rng = np.random.default_rng(cut)
    record = log(
        brush=np.asarray(log().planned) + rng.normal(size=(STEPS, 3)) * 0.01,
        halted=rng.uniform(size=STEPS) < 0.5,
        live=rng.uniform(size=STEPS) < 0.8,
    )
    # Padded with steps that are not live, as the last stretch of a run is.
    dead = replace(record, live=jnp.zeros(STEPS, bool))
    first = jax.tree.map(lambda x, y: jnp.concatenate([x[:cut], y[cut:]]), record, dead)
    second = jax.tree.map(lambda x, y: jnp.concatenate([y[:cut], x[cut:]]), record, dead)
    chart = plane().chart
    parts = SCORE(ACCUMULATE(ACCUMULATE(Tally.zero(), first, chart), second, chart))
    jax.tree.map(lambda a, b: np.testing.assert_allclose(a, b, rtol=1e-4), parts, scored(record, chart))


def test_one_bad_step_is_a_diverged_world_with_finite_figures(plane):
    record = log()
    bad = replace(record, brush=record.brush.at[7].set(jnp.nan))
    score = scored(bad, plane().chart)
    assert verdict(score) is Status.DIVERGED
    assert all(np.isfinite(leaf).all() for leaf in jax.tree.leaves(score))
    padded = replace(bad, live=bad.live.at[7].set(False))
    assert verdict(scored(padded, plane().chart)) is Status.OK


@pytest.mark.parametrize(("share", "status"), [(0.04, Status.OK), (0.06, Status.NOT_CONVERGED)])
def test_ok_asks_for_95_percent_within_30_mm(plane, share, status):
    brush = np.asarray(log().planned).copy()
    brush[: round(share * STEPS), 2] += 0.031
    assert verdict(scored(log(brush=brush), plane().chart)) is status


def test_the_first_cause_is_the_verdict(plane):
    score = scored(log(), plane().chart)
    assert verdict(score, completed=False) is Status.NOT_CONVERGED
    assert verdict(score, completed=False, infeasible=True) is Status.INFEASIBLE
    assert verdict(score, completed=False, infeasible=True, unreachable=True) is Status.UNREACHABLE
    lost = scored(log(brush=np.asarray(log().planned) + 2), plane().chart)
    assert verdict(lost, unreachable=True) is Status.DIVERGED


def test_a_pen_that_never_went_down_is_no_success(plane):
    score = scored(log(pen=np.zeros(STEPS)), plane().chart)
    assert verdict(score) is Status.NOT_CONVERGED
    assert all(np.isfinite(leaf).all() for leaf in jax.tree.leaves(score))
