"""`jaxpaint reproduce`: the papers' tables and figures, published against ours."""

import dataclasses
from pathlib import Path
from typing import Annotated

from tyro.conf import Positional

from experiments import values as allowed
from experiments.commands.command import Command, Outcome, RunOptions
from experiments.options import refuse
from experiments.output import RunFolder
from experiments.progress import progress
from experiments.report.pictures import write_pictures
from experiments.reproduce import MEASURED, REPRODUCTIONS, ReproduceResult, ReproduceSettings, load


@dataclasses.dataclass(frozen=True, kw_only=True)
class ReproduceOptions(RunOptions):
    """Make one of the papers' tables or figures, or all of them: published against ours."""

    name: Annotated[Positional[str], allowed.choice(*REPRODUCTIONS, "all")]
    """Which one."""
    data: Annotated[Path | None, allowed.data_folder(unset="none")] = None
    """For sensor-noise: the folder with clouds/ and rgbd/, captured pictures and clouds; without it `all`
    leaves sensor-noise out."""

    def check(self) -> None:
        """Raise InputError for the first option that is not allowed, alone or beside another."""
        super().check()
        for when in self.without_effect().values():
            refuse("--data", self.data, f"only {when}", "no effect")
        if self.data is None and self.name in MEASURED:
            refuse("--data", "none", f"the folder with clouds/ and rgbd/, for {self.name}")
        if self.data is not None:
            from experiments.sensing import missing_file

            missing = missing_file(self.data)
            if missing is not None:
                refuse("--data", self.data, f"a folder that has {missing}")

    def without_effect(self) -> dict[str, str]:
        """Options that do nothing beside the others though they are set, and when they would do something."""
        idle = self.data is not None and self.name not in (*MEASURED, "all")
        return {"data": f"for {', '.join(MEASURED)}, all"} if idle else {}


def execute(options: ReproduceOptions, folder: RunFolder) -> Outcome:
    """Run what was asked for; each picture is also a PNG of its own."""
    from experiments.report.studies import build_page, result_table

    results = _results(options)
    for name, result in results.items():
        write_pictures(folder, result.figures, f"{name}-")
    return Outcome(
        summary={
            "table": [{**row, "study": name} for name, result in results.items() for row in result.table],
            "left_out": _left_out(options),
        },
        tables=tuple(result_table(name, result) for name, result in results.items()),
        report=lambda summary: build_page(results, summary),
    )


def _results(options: ReproduceOptions) -> dict[str, ReproduceResult]:
    names = list(REPRODUCTIONS) if options.name == "all" else [options.name]
    names = [name for name in names if name not in _left_out(options)]
    settings = ReproduceSettings(seed=options.seed, data=options.data)
    results = {}
    with progress("reproduce", len(names)) as bar:
        for name in names:
            bar.describe(name)
            results[name] = load(name).run(settings)
            bar.advance()
    return results


def _left_out(options: ReproduceOptions) -> list[str]:
    """What of all cannot be made without --data."""
    return list(MEASURED) if options.name == "all" and options.data is None else []


COMMAND = Command("reproduce", ReproduceOptions, execute)
