import hypothesis
import hypothesis.strategies as st
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.mapping.time_law import time_for, travelled

LENGTHS = st.floats(1e-3, 3.0)
SPEEDS = st.floats(0.01, 0.3)
LIMITS = st.floats(0.05, 2.0)


@jax.jit
def profile(length, speed, acceleration):
    whole = time_for(length, speed, acceleration)
    time = jnp.linspace(-0.1, 1.1, 1201) * whole
    way = jax.vmap(lambda t: travelled(t, length, speed, acceleration))(time)
    return whole, time, way


@pytest.mark.usefixtures("x64")
@hypothesis.given(LENGTHS, SPEEDS, LIMITS)
def test_limits_are_kept_and_the_way_is_done(length, speed, acceleration):
    whole, time, way = profile(length, speed, acceleration)
    step = time[1] - time[0]
    rate = jnp.diff(way) / step
    gain = jnp.diff(rate) / step
    assert float(way[0]) == 0 and float(way[-1]) == pytest.approx(length, rel=1e-9)
    assert float(rate.min()) >= -1e-9 and float(rate.max()) <= speed * (1 + 1e-6)
    assert float(jnp.abs(gain).max()) <= acceleration * (1 + 1e-3)
    # the acceleration has no jump: it builds up in a tenth of a second at least
    assert float(jnp.abs(jnp.diff(gain)).max()) < 1.01 * acceleration / 0.1 * float(step)
    assert float(whole) >= length / speed


def test_a_long_way_is_done_at_full_speed():
    rate = jax.grad(travelled)(5.0, 1.0, 0.1, 0.5)
    assert float(rate) == pytest.approx(0.1, rel=1e-5)
    assert float(time_for(jnp.asarray(1.0), 0.1, 0.5)) == pytest.approx(1.0 / 0.1 + 0.1 / 0.5 + 0.1)


def test_no_way_takes_no_time():
    zero = jnp.zeros(())
    assert float(time_for(zero, 0.1, 0.5)) == 0
    assert float(travelled(jnp.asarray(1.0), zero, 0.1, 0.5)) == 0
    slopes = jax.grad(lambda length, speed: time_for(length, speed, 0.5), argnums=(0, 1))(
        zero, jnp.asarray(0.1)
    )
    assert np.all(np.isfinite(slopes))
