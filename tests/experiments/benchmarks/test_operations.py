import jax
import jax.numpy as jnp

from experiments.benchmarks.operations import operations


def test_counts_arithmetic_products_sums_and_rounds():
    x = jnp.ones(4)
    assert operations(lambda x: 2 * x + 1, x) == 8
    assert operations(lambda x: (x * x).sum(), x) == 8
    assert operations(lambda x: x @ x, x) == 8
    assert operations(lambda x: jax.lax.fori_loop(0, 5, lambda i, x: x * 2, x), x) == 20
