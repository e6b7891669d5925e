"""Our speed beside what a user would write today, measured in one run: `jaxpaint bench`.

A benchmark takes nothing and returns a `Bench`. Its module and its peers (the extra `bench`) are imported
when it runs, not before, so that the rest of the package works without them.
"""

from collections.abc import Callable

from experiments.benchmarks.rows import Bench, BenchRow


def _control() -> Bench:
    from experiments.benchmarks import control

    return Bench(control.rows())


def _painting() -> Bench:
    from experiments.benchmarks import painting

    return Bench(painting.rows())


def _worlds() -> Bench:
    from experiments.benchmarks import worlds

    return worlds.measured()


BENCHMARKS: dict[str, Callable[[], Bench]] = {"control": _control, "painting": _painting, "worlds": _worlds}

__all__ = ["BENCHMARKS", "Bench", "BenchRow"]
