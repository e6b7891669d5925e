"""`jaxpaint reproduce`: the papers' tables and figures, published against ours."""

import dataclasses
from typing import Annotated

from tyro.conf import Positional

from experiments import values as allowed
from experiments.commands.command import Command, Outcome, RunOptions
from experiments.output import RunFolder
from experiments.progress import progress
from experiments.report.pictures import write_pictures
from experiments.reproduce import REPRODUCTIONS, ReproduceResult, ReproduceSettings, load


@dataclasses.dataclass(frozen=True, kw_only=True)
class ReproduceOptions(RunOptions):
    """Make one of the papers' tables or figures, or all of them: published against ours."""

    name: Annotated[Positional[str], allowed.choice(*REPRODUCTIONS, "all")]
    """Which one."""


def execute(options: ReproduceOptions, folder: RunFolder) -> Outcome:
    """Run what was asked for; each picture is also a PNG of its own."""
    from experiments.report.studies import build_page, result_table

    results = _results(options)
    for name, result in results.items():
        write_pictures(folder, result.figures, f"{name}-")
    return Outcome(
        summary={
            "table": [{**row, "study": name} for name, result in results.items() for row in result.table]
        },
        tables=tuple(result_table(name, result) for name, result in results.items()),
        report=lambda summary: build_page(results, summary),
    )


def _results(options: ReproduceOptions) -> dict[str, ReproduceResult]:
    names = list(REPRODUCTIONS) if options.name == "all" else [options.name]
    results = {}
    with progress("reproduce", len(names)) as bar:
        for name in names:
            bar.describe(name)
            results[name] = load(name).run(ReproduceSettings(seed=options.seed))
            bar.advance()
    return results


COMMAND = Command("reproduce", ReproduceOptions, execute)
