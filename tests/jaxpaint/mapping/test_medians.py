import jax.numpy as jnp
import numpy as np

from jaxpaint.mapping.medians import median_of


def test_only_what_counts_is_looked_at():
    values = jnp.array([5.0, jnp.nan, 1.0, 3.0, 100.0])
    assert float(median_of(values, jnp.array([True, True, True, True, False]))) == 3.0
    assert np.isnan(median_of(values, jnp.array([False, True, False, False, False])))
