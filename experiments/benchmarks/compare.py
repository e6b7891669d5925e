"""Times ours and a peer in turn, because the speed of a shared machine drifts while it is measured."""

import statistics
import time
from collections.abc import Callable

from experiments.benchmarks.rows import BenchRow

# What takes less is repeated: a shorter measurement catches one disturbance or none [s].
_LEAST = 0.3


def compare(
    name: str, ours: Callable[[], float], peer: Callable[[], float], peer_name: str, rounds: int = 5
) -> BenchRow:
    """The median rates of `rounds` measurements each, ours and the peer's alternating.

    Both callables do the work once and return its rate [1/s]; the first call of each is not counted, since it
    compiles and fills caches.
    """
    if rounds < 1:
        raise ValueError(f"rounds: at least 1 is needed, found {rounds}")
    ours()
    peer()
    pairs = [(ours(), peer()) for _ in range(rounds)]
    our_rates, peer_rates = zip(*pairs, strict=True)
    return BenchRow(name, statistics.median(our_rates), statistics.median(peer_rates), peer_name)


def rate(work: Callable[[], object], count: int) -> float:
    """How often `work`, which does something `count` times, does it [1/s], over a third of a second."""
    begin, calls, seconds = time.perf_counter(), 0, 0.0
    while seconds < _LEAST:
        work()
        calls += 1
        seconds = time.perf_counter() - begin
    return calls * count / seconds
