"""Our speed beside what a user would write today, measured in one run: `jaxpaint bench`.

A benchmark takes nothing and returns rows. Its module and its peers (the extra `bench`) are imported when it
runs, not before, so that the rest of the package works without them.
"""

from collections.abc import Callable

from experiments.benchmarks.rows import BenchRow

BENCHMARKS: dict[str, Callable[[], list[BenchRow]]] = {}

__all__ = ["BENCHMARKS", "BenchRow"]
