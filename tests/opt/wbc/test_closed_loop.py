"""The reference robot in a closed loop: clearance, out of reach, contradictions, S1-(12) as printed."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.compiling import batched
from jaxpaint.decisions import default_thresholds
from jaxpaint.kinematics import frames, own_gap_slope, plane_gap_slope
from opt.wbc import ControlStatus, default_settings
from tests.opt.wbc.conftest import DT, STEPS, straight

INF = np.inf


def changed(**changes):
    settings = default_settings()
    return eqx.tree_at(
        lambda s: [getattr(s, name) for name in changes],
        settings,
        [jnp.asarray(value, jnp.float32) for value in changes.values()],
    )


@pytest.fixture(scope="module")
def trials(ordinary, brush):
    still = default_thresholds(release_margin=INF)
    stand = straight(brush.p, [0, 0, 0], STEPS, brush.R)
    apart = {"own_approach": INF, "wall_approach": INF}
    # The base comes nearer behind a brush that stands still: the arm folds into itself.
    folding = ordinary._replace(
        thresholds=default_thresholds(release_margin=0.0, halt_travel=INF),
        rows=stand,
        station=np.array([0.8, 0, 0], "f"),
    )
    # The brush may tilt, and manipulability leans the hand against the wall.
    lean = {
        "hold_error": 5.0,
        "slack_cost": [1e4] * 3 + [0.0] * 3,
        "manipulability": 1.0,
        "arm_effort": [1e-4] * 6,
    }
    leaning = ordinary._replace(thresholds=still, rows=straight(brush.p, [0, 0, 0.03], STEPS, brush.R))
    away = straight(brush.p, [0.3, 0, 0], STEPS, brush.R)
    return {
        "ordinary": ordinary,
        "folding": folding,
        "folding, no rows": folding._replace(settings=changed(**apart)),
        "leaning": leaning._replace(settings=changed(**lean)),
        "leaning, no rows": leaning._replace(settings=changed(**lean, **apart)),
        "out of reach": ordinary._replace(thresholds=still, rows=away, settings=changed(patience=2.0)),
        "out of reach, waiting": ordinary._replace(
            thresholds=still, rows=away, settings=changed(patience=INF)
        ),
        "contradictory": ordinary._replace(settings=changed(arm_speed=-0.5)),
        "not a number": ordinary._replace(settings=changed(manipulability=np.nan)),
        "singular": ordinary._replace(arm=np.array([0, -0.5, 0, 0, 0, 0], "f")),
        "as printed": ordinary._replace(
            thresholds=default_thresholds(one_sided=1.0, dwell=0.0, release_margin=0.0)
        ),
    }


@pytest.fixture(scope="module")
def seen(follow, trials):
    every = follow(*trials.values())
    assert follow.program.traces == 1
    return {name: jax.tree.map(lambda x, i=i: x[i], every) for i, name in enumerate(trials)}


@pytest.fixture(scope="module")
def gaps(limits, seen, trials):
    """Least gap of the run between parts of the robot, and to the plane of the reference."""

    def at(limits, base, arm, row):
        links = frames(limits.chain, jnp.concatenate([base, arm]))
        sharp, reach = jnp.float32(1e-4), jnp.float32(0.6)
        axis = row[3:12].reshape(3, 3)[:, 2]
        own = own_gap_slope(limits.chain, limits.parts, links, sharp)
        wall = plane_gap_slope(limits.chain, limits.parts.skin, links, row[:3], axis, reach, sharp)
        return own.value, wall.value

    program = batched(at, in_axes=(None, 0, 0, 0))

    def least(name):
        rows = np.asarray(trials[name].rows)[np.clip((seen[name].clock / DT).astype(int), 0, STEPS - 1)]
        return [float(np.min(x)) for x in program(limits, seen[name].base, seen[name].arm, rows)]

    return least


def test_on_an_ordinary_path_every_program_is_solved_and_nothing_is_near(seen, gaps):
    assert not seen["ordinary"].status.any()
    assert seen["ordinary"].error[5:].max() < 1e-3
    own, wall = gaps("ordinary")
    assert own > 0.03 and wall > 0.05


def test_the_arm_does_not_fold_into_itself(seen, gaps):
    assert gaps("folding, no rows")[0] < -0.05
    assert gaps("folding")[0] > 0.005
    assert seen["folding"].error.max() < 0.003
    assert not seen["folding"].status.any()


def test_the_arm_does_not_lean_against_the_wall(seen, gaps):
    assert gaps("leaning, no rows")[1] < -0.03
    assert gaps("leaning")[1] > 0.005
    assert (seen["leaning"].status == ControlStatus.SOLVED).mean() > 0.98
    assert not (seen["leaning"].status == ControlStatus.INFEASIBLE).any()


def test_a_target_out_of_reach_is_given_up_where_the_brush_came_nearest(seen):
    run = seen["out of reach"]
    first = int(np.argmax(run.status == ControlStatus.OUT_OF_REACH))
    assert first > 2.0 / DT
    assert (run.status[first:] == ControlStatus.OUT_OF_REACH).all()
    assert np.abs(run.arm_velocity[first + 75 :]).max() < 1e-3 and not run.twist[first + 25 :].any()
    assert run.clock[-1] == run.clock[first + 25]
    stood = run.clock[1:first] == run.clock[: first - 1]
    assert run.error[-1] < run.error[1:first][stood].min() + 1e-4
    waiting = seen["out of reach, waiting"]
    assert not (waiting.status == ControlStatus.OUT_OF_REACH).any()
    np.testing.assert_array_equal(waiting.arm[:first], run.arm[:first])


def test_contradictory_bounds_hold_the_robot_still_and_say_so(seen):
    run = seen["contradictory"]
    assert (run.status == ControlStatus.INFEASIBLE).all()
    assert not run.arm_velocity.any() and not run.twist.any()
    run = seen["not a number"]
    assert (run.status == ControlStatus.NOT_FINITE).all()
    assert not run.arm_velocity.any() and not run.twist.any()


def test_nothing_ever_stops_being_finite(seen):
    for name, run in seen.items():
        assert all(np.isfinite(x).all() for x in run), name


def test_from_a_singular_posture_the_brush_comes_back(seen):
    assert seen["singular"].error[-1] < 1e-3
    assert seen["singular"].status[-50:].max() == 0


def test_neighbours_of_bad_worlds_are_the_same_to_the_bit(follow, seen, trials):
    bad = trials["contradictory"], trials["not a number"], trials["out of reach"]
    alone = follow(*[trials["ordinary"]] * 2)
    beside = follow(bad[0], trials["ordinary"], bad[1], bad[2])
    for x, y, z in zip(alone, beside, seen["ordinary"], strict=True):
        np.testing.assert_array_equal(x[0], y[1])
        np.testing.assert_array_equal(x[0], z)


def test_as_printed_the_base_keeps_ahead_of_the_brush_and_halts_for_one_step(seen):
    run = seen["as printed"]
    free = run.halted == 0
    quick = run.base_velocity[:, 1] > 3 * 0.05 - 1e-4
    starting = np.zeros(STEPS, bool)
    for k in np.flatnonzero(~free):
        starting[k : k + 30] = True  # it gathers speed again
    assert (run.halted[1:] == 1).sum() >= 2
    assert not (~free[1:-1] & ~free[2:]).any()  # dwell 0: one control step
    assert quick[30:][~starting[30:]].all()
    travel = np.abs(np.diff(run.base[:, 1])).sum()
    assert (run.halted[1:] == 1).sum() == int(travel / 0.4)
