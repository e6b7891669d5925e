import math

import pytest

from experiments.benchmarks import BENCHMARKS, BenchRow


def test_ratio_says_how_many_times_faster_ours_is():
    row = BenchRow("control-step", ours=500.0, peer=20.0, peer_name="serial loop")
    assert row.to_dict() == {
        "name": "control-step",
        "ours": 500.0,
        "peer": 20.0,
        "peer_name": "serial loop",
        "ratio": 25.0,
    }


@pytest.mark.parametrize("rate", [0.0, -1.0, math.nan, math.inf])
@pytest.mark.parametrize("field", ["ours", "peer"])
def test_a_rate_that_is_no_rate_is_refused(field: str, rate: float):
    rates = {"ours": 1.0, "peer": 1.0} | {field: rate}
    with pytest.raises(ValueError, match=f"{field}: a rate is finite"):
        BenchRow("control-step", **rates, peer_name="serial loop")


def test_a_benchmark_is_something_to_call():
    assert all(callable(benchmark) for benchmark in BENCHMARKS.values())
