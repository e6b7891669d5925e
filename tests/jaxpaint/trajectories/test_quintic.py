"""Quintics: through both ends, within the limits, no longer than needed."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.trajectories import State, evaluate, fastest_quintic, quintic, rest_duration

V, A = np.array([0.5, 1.0, 3.0]), np.array([0.5, 1.0, 8.0])


def state(p, v, a):
    return State(*(jnp.asarray(np.broadcast_to(x, 3), float) for x in (p, v, a)))


def sampled(curve, count=400):
    times = jnp.linspace(0, curve.duration, count)
    return jax.tree.map(np.asarray, jax.jit(jax.vmap(evaluate, in_axes=(None, 0)))(curve, times)), np.asarray(
        times
    )


def test_both_ends_are_met_and_speeds_are_derivatives(x64):
    start, end = state([0.1, -1, 2], [0.3, 0, -1], [0, 0.5, 1]), state([1, 0, -2], [0, 0.2, 1], [-0.1, 0, 0])
    curve = quintic(start, end, jnp.asarray(2.5))
    s, times = sampled(curve)
    for name in ("p", "v", "a"):
        np.testing.assert_allclose(getattr(s, name)[0], getattr(start, name), atol=1e-12)
        np.testing.assert_allclose(getattr(s, name)[-1], getattr(end, name), atol=1e-12)
    step = times[1]
    np.testing.assert_allclose((s.p[2:] - s.p[:-2]) / (2 * step), s.v[1:-1], atol=1e-3)
    np.testing.assert_allclose((s.v[2:] - s.v[:-2]) / (2 * step), s.a[1:-1], atol=1e-3)


@pytest.mark.parametrize("way", [[0.02, 0, 0], [3, 0.1, 0], [0.5, -4, 6], [0, 0, -0.3]])
def test_from_rest_to_rest_one_limit_is_just_reached(way, x64):
    way = np.array(way, float)
    duration = rest_duration(jnp.asarray(way), V, A)
    s, _ = sampled(quintic(state(0, 0, 0), state(way, 0, 0), duration), 2001)
    use = max((np.abs(s.v).max(0) / V).max(), (np.abs(s.a).max(0) / A).max())
    assert use == pytest.approx(1, abs=1e-5)


def test_no_way_takes_no_time_and_has_finite_gradients():
    assert float(rest_duration(jnp.zeros(3), V, A)) == 0
    slope = jax.jit(jax.jacrev(lambda way: rest_duration(way, V, A)))(jnp.zeros(3))
    assert bool(jnp.isfinite(slope).all())
    rest = evaluate(quintic(state(0.7, 0, 0), state(0.7, 0, 0), jnp.asarray(0.0)), jnp.asarray(1.0))
    np.testing.assert_allclose(rest.p, 0.7, rtol=1e-6)
    np.testing.assert_array_equal(np.asarray([rest.v, rest.a]), 0)


@pytest.fixture
def fastest(x64):
    run = jax.jit(fastest_quintic)
    return lambda start, end: run(start, end, jnp.asarray(V), jnp.asarray(A))


def test_from_rest_to_rest_the_search_finds_the_closed_form(fastest):
    curve, found = fastest(state(0, 0, 0), state([0.5, -4, 6], 0, 0))
    shortest = float(rest_duration(jnp.array([0.5, -4, 6]), V, A))
    assert bool(found) and shortest <= float(curve.duration) * (1 + 1e-5)
    assert float(curve.duration) < 1.08 * shortest


@pytest.mark.parametrize("seed", range(4))
def test_moving_ends_keep_the_limits(seed, fastest):
    rng = np.random.default_rng(seed)
    ends = [state(*(rng.uniform(-1, 1, (3, 3)) * [[1], [0.8], [0.3]] * [[1, 1, 1], V, A])) for _ in range(2)]
    curve, found = fastest(*ends)
    assert bool(found)
    s, _ = sampled(curve, 2001)
    assert (np.abs(s.v) <= V * (1 + 1e-4)).all() and (np.abs(s.a) <= A * (1 + 1e-4)).all()
    np.testing.assert_allclose(s.v[-1], ends[1].v, atol=1e-9)


def test_ends_beyond_the_limits_are_refused(fastest):
    _, found = fastest(state(0, [0.6, 0, 0], 0), state(1, 0, 0))
    assert not bool(found)
