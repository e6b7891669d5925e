"""Quantiles from bins against numpy."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from sims.scoring import Histogram

ADD = jax.jit(Histogram.add)
QUANTILE = jax.jit(Histogram.quantile)


@pytest.mark.parametrize("share", [0.05, 0.5, 0.95, 1.0])
def test_quantile_is_right_to_a_bin(share):
    values = np.random.default_rng(0).gamma(2.0, 0.01, 999).astype(np.float32)
    histogram = Histogram.empty(2000, 1e-4, jnp.float32)
    for part in np.split(values, 3):
        histogram = ADD(histogram, jnp.asarray(part), jnp.ones(333, bool))
    exact = np.sort(values)[int(np.ceil(share * 999)) - 1]
    found = float(QUANTILE(histogram, share))
    assert exact - 1e-7 <= found <= exact + 1.01e-4


def test_uncounted_values_and_empty_histograms():
    histogram = Histogram.empty(10, 0.1, jnp.float32)
    assert histogram.quantile(0.5) == 0
    histogram = histogram.add(jnp.asarray([0.55, jnp.nan, 0.95]), jnp.asarray([True, False, False]))
    assert histogram.quantile(0.5) == pytest.approx(0.6)


def test_values_beyond_the_last_bin_have_no_quantile():
    histogram = Histogram.empty(10, 0.1, jnp.float32).add(jnp.asarray([1e9]), jnp.ones(1, bool))
    assert histogram.quantile(0.5) == jnp.inf
