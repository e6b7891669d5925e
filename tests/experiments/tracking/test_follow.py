"""Following a curve: the printed controller and ours, and what looking is worth."""

import dataclasses

import numpy as np
import pytest

from experiments.tracking import follow, literal, median_interval, study_of, variants, varied
from experiments.tracking.calibration import with_noise
from sims.noise import noise_preset

WORLDS = 8


@pytest.fixture(scope="module")
def study():
    """A metre and a half to and fro, which the base must follow."""
    turn = np.linspace(0, 2 * np.pi, 400)
    return study_of(np.stack([0.45 * np.sin(turn), 0.06 * np.sin(2 * turn)], axis=1))


@pytest.fixture(scope="module")
def printed(study):
    return follow(varied(study, literal(0.4)), WORLDS)


def test_the_plan_is_the_curve_at_its_speed(study):
    rows = study.plan.rows
    live = rows[: int(float(study.plan.duration) / 0.02)]
    way = np.linalg.norm(np.diff(live[:, :3], axis=0), axis=1)
    assert way.sum() == pytest.approx(study.length, rel=1e-3)
    np.testing.assert_allclose(way[10:-10] / 0.02, 0.03, rtol=0.02)
    np.testing.assert_allclose(live[1:-1, 12:15], (live[2:, :3] - live[:-2, :3]) / 0.04, atol=1e-3)
    np.testing.assert_allclose(np.linalg.norm(live[:, 5:12:3], axis=1), 1, atol=1e-5)


def test_looking_takes_away_what_odometry_drifts(study, printed):
    ours = follow(varied(study, variants()["ours"]), WORLDS)
    blind = follow(varied(study, variants()["without looking"]), WORLDS)
    assert ours.completed.all()
    middle = [float(np.median(run.score.total)) for run in (ours, blind, printed)]
    assert middle[0] < 0.003 < 0.5 * middle[1]
    assert middle[1] < middle[2]
    # Odometry itself drifts as before: what is believed is not what it says.
    assert np.median(ours.score.drift_largest) > 0.6 * np.median(blind.score.drift_largest)


def test_the_error_by_which_the_printed_controller_weighs_does_not_matter(study, printed):
    """S1 does not print it: ten times as large it changes little."""
    looser = dataclasses.replace(literal(0.4), weights=(0.01 / 1e-3, 1 / 1e-3))
    median = np.median(follow(varied(study, looser), WORLDS).score.total)
    assert median == pytest.approx(np.median(printed.score.total), rel=0.05)


def test_nothing_drifts_in_a_perfect_world(study):
    perfect = noise_preset("none")
    none = dataclasses.replace(study, job=dataclasses.replace(study.job, noise=perfect))
    run = follow(varied(none, variants()["without looking"]), WORLDS)
    assert run.score.drift_largest.max() < 1e-5
    assert run.score.total.max() < 5e-4


def test_more_noise_is_more_error(study):
    blind = varied(study, variants()["without looking"])
    little, much = (np.median(follow(with_noise(blind, f), WORLDS).score.total) for f in (1.0, 4.0))
    assert much == pytest.approx(4 * little, rel=0.15)


def test_the_median_lies_in_its_interval():
    rng = np.random.default_rng(0)
    middle, low, high = median_interval(rng.normal(size=256))
    assert low < middle < high
    hits = 0
    for _ in range(400):
        _, low, high = median_interval(rng.normal(size=64))
        hits += low <= 0 <= high
    assert 0.92 <= hits / 400 <= 0.99
