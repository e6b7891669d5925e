"""Single limits: bounds and rows against their equations."""

import jax.numpy as jnp
import numpy as np
from scipy.optimize import linprog

from jaxpaint.decisions import default_thresholds
from jaxpaint.kinematics import Gap
from jaxpaint.steering import differential, mecanum
from opt.wbc.limits import (
    as_bounds_allow,
    braked,
    clearance,
    damper_bounds,
    low_speed_bounds,
    nonholonomic,
    nonholonomic_rows,
    possible_part,
    with_braking,
    within_acceleration,
)
from opt.wbc.pieces import Bounds, Inequalities, met

SPEED = jnp.asarray([0.5, 0.5, 1.0])
DEMAND = jnp.asarray([0.1, -0.2, 0.3])
ONE = jnp.float32(1)


def low_speed(brush, gate=1.0, **changes):
    return low_speed_bounds(DEMAND, gate * ONE, jnp.asarray(brush), SPEED, default_thresholds(**changes))


def test_signed_the_base_moves_with_the_demand_or_not_at_all():
    lower, upper = low_speed([0.03, 0.0, 0.0])
    np.testing.assert_allclose(lower, [0, -0.2, 0], rtol=1e-6)
    np.testing.assert_allclose(upper, [0.1, 0, 0.3], rtol=1e-6)


def test_as_printed_only_lower_bounds_follow_the_brush_whatever_its_sign():
    lower, upper = low_speed([0.03, -0.02, 0.5], one_sided=1.0)
    np.testing.assert_allclose(lower, [0.09, -0.06, -1.0], rtol=1e-6)
    np.testing.assert_allclose(upper, SPEED, rtol=1e-6)
    lower, _ = low_speed([9.0, -9.0, 0.0], one_sided=1.0)
    np.testing.assert_allclose(lower, [0.5, -0.5, -1.0], rtol=1e-6)


def test_a_shut_gate_and_a_rule_that_is_off():
    for changes in ({}, {"one_sided": 1.0}, {"low_speed_scale": 0.0}):
        for bound in low_speed([0.03, -0.02, 0.0], gate=0.0, **changes):
            np.testing.assert_array_equal(bound, 0)
    for one_sided in (0.0, 1.0):
        lower, upper = low_speed([0.03, -0.02, 0.0], low_speed_scale=0.0, one_sided=one_sided)
        np.testing.assert_allclose([-lower, upper], [SPEED, SPEED], rtol=1e-6)


def test_dampers_fall_to_zero_and_can_be_left_out():
    q, low, high = jnp.asarray([0.9, 0.96, 0.5, 1.2]), jnp.full(4, -1.0), jnp.full(4, 1.0)
    bounds = damper_bounds(q, low, high, jnp.full(4, 2.0), 0.25 * ONE, 0.05 * ONE)
    np.testing.assert_allclose(bounds.upper, [0.5, 0, 4.5, 0], atol=1e-5)
    off = damper_bounds(q, low, high, jnp.full(4, 2.0), 0 * ONE, 0.05 * ONE)
    assert np.isinf(off.lower).all() and np.isinf(off.upper).all()


def test_acceleration_is_met_as_far_as_it_can_be():
    bounds = within_acceleration(
        Bounds(jnp.zeros(2), jnp.zeros(2)), jnp.asarray([0.5, 0.01]), jnp.full(2, 0.1)
    )
    np.testing.assert_allclose(bounds, [[0.4, 0], [0.4, 0]], atol=1e-7)
    free = within_acceleration(Bounds(-SPEED, SPEED), jnp.zeros(3), jnp.full(3, jnp.inf))
    np.testing.assert_array_equal(free, [-SPEED, SPEED])
    np.testing.assert_allclose(braked(jnp.asarray([0.5, -0.01]), jnp.full(2, 0.1)), [0.4, 0], atol=1e-7)


def test_bounds_that_contradict_stay_contradictory():
    lower, upper = met([Bounds(jnp.zeros(1), jnp.ones(1)), Bounds(jnp.full(1, 2.0), jnp.full(1, 3.0))])
    assert lower > upper


def test_a_differential_base_goes_along_its_heading():
    for axle in (0.0, 0.2):
        base = differential(0.5 * ONE, axle * ONE, ONE)
        rows = nonholonomic_rows(base, 0.7 * ONE)
        ahead = np.array([np.cos(0.7), np.sin(0.7), 0])
        turn = np.array([axle * np.sin(0.7), -axle * np.cos(0.7), 1])
        np.testing.assert_allclose(rows @ np.stack([ahead, turn], 1), 0, atol=1e-6)
        left = possible_part(rows, jnp.asarray([0.3, -0.4, 0.2]))
        np.testing.assert_allclose(rows @ left, 0, atol=1e-6)
        np.testing.assert_allclose(possible_part(rows, left), left, atol=1e-6)
        whole = nonholonomic(rows, ONE, 6)
        assert whole.rows.shape == (1, 9) and float(whole.compliance[0]) == 0
        off = nonholonomic(rows, 0 * ONE, 6)
        assert not np.any(off.rows) and float(off.compliance[0]) > 0


def test_braking_stays_on_the_way_of_the_base():
    rows = nonholonomic_rows(differential(0.5 * ONE, 0 * ONE, ONE), 0.3 * ONE)
    velocity = jnp.asarray([0.3 * np.cos(0.3), 0.3 * np.sin(0.3), 0.4], jnp.float32)
    step = jnp.full(3, 0.01)
    stop = within_acceleration(Bounds(jnp.zeros(3), jnp.zeros(3)), velocity, step)
    lower, upper = with_braking(stop, rows, velocity, step)
    slower = velocity * (1 - 0.01 / 0.4)
    assert (lower <= slower + 1e-6).all() and (slower <= upper + 1e-6).all()
    assert (velocity - step <= lower + 1e-6).all() and (upper <= velocity + step + 1e-6).all()
    corners = jnp.asarray([[1, 1], [1, -1], [-1, 1], [-1, -1]]) * 0.2
    free = nonholonomic_rows(mecanum(corners, 0.8 * ONE, ONE), 0.3 * ONE)
    assert free.shape == (0, 3) and with_braking(stop, free, velocity, step) is stop


def test_clearance_is_the_law_of_faverjon_and_tournassoud():
    slope = jnp.asarray([1.0, -2.0])
    for gap, limit, share in (
        (0.09, 0.2, 1),
        (0.05, 0.1, 1),
        (0.03, 0.05, 0.5),
        (0.01, 0, 0.2),
        (-0.2, -0.1, 0.2),
    ):
        found = clearance(Gap(jnp.float32(gap), slope), 0.1 * ONE, 0.05 * ONE, 0.01 * ONE)
        np.testing.assert_allclose(found.row.rows, [[-1, 2]])
        np.testing.assert_allclose(found.row.limit, [limit], atol=1e-6)
        np.testing.assert_allclose(found.speed_share, share, atol=1e-6)
    off = clearance(Gap(jnp.float32(-0.2), slope), jnp.float32(np.inf), 0.05 * ONE, 0.01 * ONE)
    assert not np.any(off.row.rows) and float(off.row.limit[0]) > 0 and float(off.speed_share) == 1


def test_a_row_asks_for_no_more_than_the_bounds_allow():
    rows = Inequalities(jnp.asarray([[1.0, -2.0], [1.0, 0.0]]), jnp.asarray([-9.0, 0.3]))
    bounds = Bounds(jnp.asarray([-0.1, 0.0]), jnp.asarray([0.1, 0.2]))
    np.testing.assert_allclose(as_bounds_allow(rows, bounds).limit, [-0.5 + 0.05 * 0.6, 0.3], atol=1e-6)


def test_two_rows_ask_for_no_more_than_can_be_met_together():
    """Each alone could be met, x >= 0.08 and x <= -0.08 not both; with three variables, at random."""
    opposite = Inequalities(jnp.asarray([[-1.0, 0.0], [1.0, 0.0]]), jnp.asarray([-0.08, -0.08]))
    bounds = Bounds(jnp.full(2, -0.1), jnp.full(2, 0.1))
    limit = np.asarray(as_bounds_allow(opposite, bounds).limit)
    assert limit.sum() >= 0 and (limit <= 0.1).all()
    rng = np.random.default_rng(0)
    for _ in range(50):
        rows = Inequalities(jnp.asarray(rng.normal(size=(2, 3))), jnp.asarray(rng.normal(size=2) - 0.5))
        lower, upper = -rng.uniform(0.05, 0.5, 3), rng.uniform(0.05, 0.5, 3)
        given = as_bounds_allow(rows, Bounds(jnp.asarray(lower), jnp.asarray(upper)))
        found = linprog(np.zeros(3), given.rows, given.limit, bounds=list(zip(lower, upper, strict=True)))
        assert found.status == 0
        alone = [
            linprog(row, bounds=list(zip(lower, upper, strict=True))).fun for row in np.asarray(rows.rows)
        ]
        size = np.abs(np.asarray(rows.rows)) @ (upper - lower)
        wanted = np.maximum(rows.limit, alone + 0.05 * size)
        both = linprog(np.zeros(3), rows.rows, wanted, bounds=list(zip(lower, upper, strict=True)))
        if both.status == 0:  # what can be met together is loosened a little at most
            assert (np.asarray(given.limit) <= wanted + 0.05 * size.max() + 1e-6).all()
