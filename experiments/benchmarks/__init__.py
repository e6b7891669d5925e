"""Our speed beside what a user would write today, measured in one run: `jaxpaint bench`.

A benchmark takes nothing and returns rows. Its module and its peers (the extra `bench`) are imported when it
runs, not before, so that the rest of the package works without them.
"""

from collections.abc import Callable

from experiments.benchmarks.rows import BenchRow


def _control() -> list[BenchRow]:
    from experiments.benchmarks import control

    return control.rows()


def _painting() -> list[BenchRow]:
    from experiments.benchmarks import painting

    return painting.rows()


BENCHMARKS: dict[str, Callable[[], list[BenchRow]]] = {"control": _control, "painting": _painting}

__all__ = ["BENCHMARKS", "BenchRow"]
