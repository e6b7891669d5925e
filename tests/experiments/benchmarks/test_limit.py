from experiments.benchmarks.limit import product_rate


def test_a_matrix_product_is_faster_than_a_core_is_slow():
    """Between one operation a nanosecond and what no two cores do."""
    assert 1e9 < product_rate() < 1e13
