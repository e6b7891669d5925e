"""S1-(13): the latch, its dwell and release, hard and relaxed."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.decisions import default_thresholds, exceeds, initial_halt, update_halt

DT = jnp.float32(0.02)


def run(thresholds, distances, travelled, arrived=0.0):
    state, seen = initial_halt(jnp.float32), []
    for distance in distances:
        moving = travelled * (1 - float(state.halted) if seen else 1)
        state = update_halt(
            state,
            jnp.float32(moving),
            jnp.float32(distance),
            jnp.float32(arrived),
            jnp.float32(1),
            thresholds,
            DT,
        )
        seen.append(float(state.halted))
    return state, np.array(seen)


def test_halts_after_theta_and_starts_over():
    thresholds = default_thresholds(halt_travel=0.1, dwell=0.2, release_margin=0.0)
    state, halted = run(thresholds, [0.3] * 100, 0.004)
    assert halted[0] == 0  # let go at once: the brush is far
    first = int(np.argmax(halted))
    assert 25 <= first <= 27  # 0.1 m in steps of 4 mm
    rest = int(np.argmax(halted[first:] == 0))
    assert 10 <= rest <= 12  # 0.2 s of dwell
    assert float(state.halts) == np.sum(np.diff(halted) > 0)


def test_stays_halted_while_the_brush_is_near():
    _, halted = run(default_thresholds(release_margin=0.2), [0.1] * 20, 0.004)
    assert halted.all()


def test_infinite_theta_never_halts():
    _, halted = run(default_thresholds(halt_travel=np.inf), [0.0] * 20, 0.01)
    assert not halted.any()


def test_arrival_halts():
    _, halted = run(default_thresholds(), [0.5] * 5, 0.0, arrived=1.0)
    assert halted.all()


def test_relaxation_meets_the_rule_as_it_cools():
    value, threshold = jnp.asarray([0.0, 0.9, 1.1, 2.0]), jnp.asarray(1.0)
    hard = exceeds(value, jnp.broadcast_to(threshold, (4,)), jnp.asarray(0.0))
    np.testing.assert_array_equal(hard, [0, 0, 1, 1])
    for temperature in (0.1, 0.01, 0.001):
        soft = exceeds(value, jnp.broadcast_to(threshold, (4,)), jnp.asarray(temperature))
        np.testing.assert_allclose(soft, jax.nn.sigmoid((value - 1) / temperature), atol=1e-6)
    np.testing.assert_allclose(soft, hard, atol=1e-6)
    slope = jax.grad(lambda t: exceeds(jnp.asarray(0.9), t, jnp.asarray(0.1)))(threshold)
    assert slope < 0


def test_unknown_thresholds_are_named():
    with pytest.raises(ValueError, match="thetta"):
        default_thresholds(thetta=1.0)
