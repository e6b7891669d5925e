"""`jaxpaint bench`: our speed beside what a user would write today, in one run."""

import dataclasses
from typing import Annotated

from tyro.conf import Positional

from experiments import values as allowed
from experiments.benchmarks import BENCHMARKS, Bench, BenchRow
from experiments.commands.command import Command, Outcome, RunOptions
from experiments.output import RunFolder
from experiments.progress import progress
from experiments.report.pictures import write_pictures
from experiments.tables import Table


@dataclasses.dataclass(frozen=True, kw_only=True)
class BenchOptions(RunOptions):
    """Measure our speed beside its peers, in one run, as ratios."""

    name: Annotated[Positional[str], allowed.choice(*BENCHMARKS, "all")] = "all"
    """What to measure."""


def execute(options: BenchOptions, folder: RunFolder) -> Outcome:
    """Rows of the benchmarks asked for; the peers come with the extra `bench`."""
    names = list(BENCHMARKS) if options.name == "all" else [options.name]
    found: dict[str, Bench] = {}
    with progress("bench", len(names)) as bar:
        for name in names:
            bar.describe(name)
            found[name] = _measured(name)
            bar.advance()
    rows = [row for bench in found.values() for row in bench.rows]
    more = {name: dict(bench.summary) for name, bench in found.items() if bench.summary}
    for bench in found.values():
        write_pictures(folder, bench.figures)
    tables = (_table(rows), *(table for bench in found.values() for table in bench.tables))
    return Outcome(summary={"rows": [row.to_dict() for row in rows], **more}, tables=tables)


def _measured(name: str) -> Bench:
    try:
        return BENCHMARKS[name]()
    except ModuleNotFoundError as error:
        raise RuntimeError(f"{name} needs {error.name}: install jaxpaint with the extra 'bench'") from error


def _table(rows: list[BenchRow]) -> Table:
    cells = tuple((row.name, row.ours, row.peer_name, row.peer, row.ratio) for row in rows)
    return Table(("row", "ours [1/s]", "peer", "peer [1/s]", "times faster"), cells, "Speed beside its peers")


COMMAND = Command("bench", BenchOptions, execute)
