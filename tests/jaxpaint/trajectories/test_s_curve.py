"""S-curves: through both ends, within the limits, no longer than needed."""

import hypothesis
import hypothesis.strategies as st
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.trajectories import progress, s_curve, stretched

LENGTHS, SPEEDS, ACCELERATIONS = st.floats(1e-4, 10), st.floats(0.05, 3), st.floats(0.1, 10)


@jax.jit
def walk(length, speed, acceleration, rounding, least, factor):
    curve = stretched(s_curve(length, speed, acceleration, rounding=rounding, least=least), factor)
    times = jnp.linspace(-0.05, 1.05, 4001) * curve.duration
    return curve, times, jax.vmap(progress, in_axes=(None, 0))(curve, times)


@pytest.mark.usefixtures("x64")
@hypothesis.given(LENGTHS, SPEEDS, ACCELERATIONS, st.floats(0.02, 1), st.floats(1e-3, 0.2), st.floats(1, 3))
def test_limits_are_kept_and_derivatives_agree(length, speed, acceleration, rounding, least, factor):
    curve, times, (way, v, a) = jax.tree.map(
        np.asarray, walk(length, speed, acceleration, rounding, least, factor)
    )
    step = times[1] - times[0]
    assert way[0] == 0 and way[-1] == pytest.approx(length, rel=1e-12)
    assert v.min() >= 0 and v.max() <= speed * (1 + 1e-9)
    assert np.abs(a).max() <= acceleration * (1 + 1e-9)
    # each is the sum of the next, and acceleration changes no faster than over its build-up time
    scale = float(curve.peak / (curve.ramp - curve.build_up))
    assert np.abs(a).max() == pytest.approx(scale, rel=0.02)
    jerk = scale / float(curve.build_up)
    np.testing.assert_allclose(np.diff(v), step * (a[1:] + a[:-1]) / 2, atol=jerk * step**2 / 4)
    np.testing.assert_allclose(np.diff(way), step * (v[1:] + v[:-1]) / 2, atol=scale * step**2)
    assert np.abs(np.diff(a)).max() <= jerk * step * (1 + 1e-6)
    assert float(curve.build_up) >= least * factor * (1 - 1e-9)


@pytest.mark.usefixtures("x64")
@hypothesis.given(LENGTHS, SPEEDS, ACCELERATIONS, st.floats(0.02, 0.5))
def test_it_is_nearly_as_fast_as_with_jumps_of_acceleration(length, speed, acceleration, rounding):
    """The trapezoid in closed form is the bound; both limits are used."""
    curve, _, (_, v, a) = walk(length, speed, acceleration, rounding, 1e-9, 1.0)
    peak = min(speed, np.sqrt(length * acceleration))
    bound = length / peak + peak / acceleration
    assert bound * (1 - 1e-9) <= float(curve.duration) <= bound * (1 + rounding * 0.55)
    assert max(float(v.max()) / speed, float(a.max()) / acceleration) > 1 - 1e-6


def test_no_way_takes_no_time_and_has_finite_gradients():
    def whole(length):
        curve = s_curve(length, 1.0, 2.0)
        return curve.duration + sum(progress(curve, jnp.asarray(0.1)))

    zero = jnp.zeros(())
    value, slope = jax.jit(jax.value_and_grad(whole))(zero)
    assert float(value) == 0 and np.isfinite(slope)


def test_far_along_single_precision_still_ends_at_the_end():
    curve = s_curve(jnp.float32(10.0), jnp.float32(0.5), jnp.float32(8.0), least=0.04)
    assert float(progress(curve, curve.duration).way) == 10.0
    # acceleration builds up over 0.04 s at 200 m/s^3: the last 0.03 s are a cubic
    near = progress(curve, curve.duration - 0.03)
    assert 10.0 - float(near.way) == pytest.approx(200 / 6 * 0.03**3, abs=2e-5)
