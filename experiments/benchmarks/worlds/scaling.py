"""Steps a second and memory against the number of worlds, for every fidelity."""

import dataclasses
import resource
from collections.abc import Sequence
from typing import Any, Protocol

import jax
from matplotlib.figure import Figure

from experiments.benchmarks.worlds.physics_rollouts import GROUP
from experiments.report.style import look
from experiments.tables import Table
from jaxpaint.compiling import Batched

WORLDS = (1, 8, 64, 512, 4096, 8192)
_ROUNDS = 3


class Measured(Protocol):
    """What runs worlds."""

    def rate(self, worlds: int | None = None) -> float:
        """Steps a second of so many."""
        ...


@dataclasses.dataclass(frozen=True)
class Point:
    """Of one fidelity with so many worlds. compile_s: seconds to trace and compile, None where that of
    another number of worlds served. rate: steps a second. memory_mb: the process's peak so far [MB].
    """

    fidelity: str
    worlds: int
    compile_s: float | None
    rate: float
    memory_mb: float


def scaling(fidelity: str, runs: Measured, worlds: Sequence[int] = WORLDS) -> list[Point]:
    """A point for each number of worlds."""
    points = []
    for count in worlds:
        before = Batched.spent_s
        runs.rate(count)
        compiled = Batched.spent_s - before
        rates = sorted(runs.rate(count) for _ in range(_ROUNDS))
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        points.append(Point(fidelity, count, compiled or None, rates[_ROUNDS // 2], peak))
    return points


def scaling_table(points: Sequence[Point]) -> Table:
    """A line for each point."""
    cells = tuple(
        (p.fidelity, p.worlds, "" if p.compile_s is None else round(p.compile_s, 1), p.rate, p.memory_mb)
        for p in points
    )
    titles = ("fidelity", "worlds", "compile [s]", "steps [1/s]", "peak memory [MB]")
    return Table(titles, cells, f"Against the number of worlds, in groups of {GROUP} at most")


def scaling_summary(points: Sequence[Point]) -> list[dict[str, Any]]:
    """The same for summary.json."""
    return [dataclasses.asdict(p) for p in points]


def scaling_figure(points: Sequence[Point], peers: dict[str, float]) -> Figure:
    """Steps a second against worlds; peers: their rates, as lines."""
    with look():
        figure = Figure(figsize=(7.0, 4.6), layout="constrained")
        axes = figure.subplots()
        for name in dict.fromkeys(p.fidelity for p in points):
            mine = [p for p in points if p.fidelity == name]
            (line,) = axes.plot([p.worlds for p in mine], [p.rate for p in mine], marker="o", label=name)
            if name in peers:
                axes.axhline(peers[name], color=line.get_color(), linestyle=":", label=f"{name}: its peer")
        axes.set_xscale("log", base=2)
        axes.set_yscale("log")
        axes.set_xlabel("worlds")
        axes.set_ylabel("steps a second")
        axes.set_title(f"{jax.default_backend()}, {jax.local_device_count()} devices")
        axes.legend()
        return figure
