"""`jaxpaint compare`: two earlier runs side by side."""

import dataclasses
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

from tyro.conf import Positional

from experiments import values as allowed
from experiments.commands.command import Command, Outcome, RunOptions
from experiments.comparison import STATISTICS, Row, Run, compare, option_differences, paired, read_run
from experiments.output import RunFolder
from experiments.tables import Table, in_words
from jaxpaint.errors import InputError


@dataclasses.dataclass(frozen=True, kw_only=True)
class CompareOptions(RunOptions):
    """Set two earlier runs of one command side by side: options, scores, differences with 95 % intervals."""

    a: Annotated[Positional[Path], allowed.earlier_run("A")]
    """The run to start from: its folder, or its summary.json."""
    b: Annotated[Positional[Path], allowed.earlier_run("B")]
    """The run to hold against it, likewise; differences are its figures less those of the first."""


def execute(options: CompareOptions, folder: RunFolder) -> Outcome:
    """Reads both runs and compares what they have in common."""
    del folder
    a, b = read_run(options.a, "A"), read_run(options.b, "B")
    if a.summary["command"] != b.summary["command"]:
        raise InputError(
            f"B: found a run of {b.summary['command']!r}, allowed: a run of {a.summary['command']!r}, as A is"
        )
    rows, changed = compare(a, b, options.seed), option_differences(a, b)
    together = paired(a, b)
    return Outcome(
        summary={
            "runs": [_about(a), _about(b)],
            "paired": together,
            "options": [{"name": name, "a": x, "b": y} for name, x, y in changed],
            "rows": [dataclasses.asdict(row) for row in rows],
        },
        tables=(option_table(changed), figure_table(rows, together)),
        report=lambda summary: _page(a, b, rows, changed, together, summary),
    )


def option_table(changed: Sequence[tuple[str, Any, Any]]) -> Table:
    """Options that differ."""
    rows = tuple((f"--{name.replace('_', '-')}", _words(x), _words(y)) for name, x, y in changed)
    return Table(("option", "A", "B"), rows or (("none differs", None, None),), "Options that differ")


def figure_table(rows: Sequence[Row], together: bool) -> Table:
    """Figures of both runs in SI, those that neither run has left out."""
    cells = tuple(
        (row.name, row.a, row.b, row.difference, _between(row))
        for row in rows
        if row.a is not None or row.b is not None
    )
    kind = "paired worlds" if together else "independent worlds"
    note = (
        f" (intervals: {kind})" if any(row.name in STATISTICS and row.low is not None for row in rows) else ""
    )
    return Table(("figure", "A", "B", "B - A", "95 %"), cells, f"Figures [SI]{note}")


def _between(row: Row) -> str | None:
    return None if row.low is None else f"{in_words(row.low)} to {in_words(row.high)}"


def _words(value: Any) -> str:
    if isinstance(value, list):
        return " ".join(_words(entry) for entry in value)
    return f"{value:.6g}" if isinstance(value, float) else in_words(value)


def _about(run: Run) -> dict[str, Any]:
    kept = {name: run.summary.get(name) for name in ("command", "seed", "versions", "device")}
    return {"folder": run.folder, **kept, "worlds": run.summary.get("worlds")}


def _page(a: Run, b: Run, rows, changed, together: bool, summary):
    from experiments.report.comparison import build_page

    return build_page(a, b, (option_table(changed), figure_table(rows, together)), rows, summary)


COMMAND = Command("compare", CompareOptions, execute)
