import pytest

from experiments.benchmarks.compare import compare, rate


def test_compare_alternates_and_takes_medians_without_the_first_call():
    order = []
    ours = iter([1e9, 3.0, 100.0, 4.0])
    peer = iter([1e9, 2.0, 1.0, 1.5])

    def measure(name, rates):
        order.append(name)
        return next(rates)

    row = compare("qp-box", lambda: measure("a", ours), lambda: measure("b", peer), "DAQP", rounds=3)
    assert (row.ours, row.peer) == (4.0, 1.5)
    assert "".join(order) == "abababab"


def test_compare_needs_a_round():
    with pytest.raises(ValueError, match="rounds: at least 1"):
        compare("qp-box", lambda: 1.0, lambda: 1.0, "DAQP", rounds=0)


def test_a_rate_counts_every_call():
    calls = []
    found = rate(lambda: calls.append(0), 10)
    assert found == pytest.approx(10 * len(calls) / 0.3, rel=0.05)
