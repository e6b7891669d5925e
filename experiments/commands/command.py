"""What a sub-command is, and what it gives back."""

import dataclasses
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from tyro.conf import Fixed, FlagCreatePairsOff, Suppress

from experiments import values as allowed
from experiments.options import check
from experiments.output import RunFolder
from experiments.tables import Table

if TYPE_CHECKING:  # a report draws figures, whose library no command line should wait for
    from experiments.report import Page


@dataclasses.dataclass(frozen=True, kw_only=True)
class RunOptions:
    """Options that every command has."""

    seed: Annotated[int, allowed.whole("N", at_least=0, at_most=2**32 - 1)] = 0
    """Seed of every random draw: the same seed gives the same figures, bit for bit, on one machine."""
    out: Annotated[Path | None, allowed.folder(unset="a new folder in runs")] = None
    """Folder for the results: new or empty."""
    overwrite: FlagCreatePairsOff[bool] = False
    """Write into --out though an earlier run is there, and replace its files."""
    config: Annotated[Path | None, allowed.file(".json")] = None
    """The summary.json of an earlier run of this command: its options, where not given here."""
    chosen: Annotated[Suppress[Fixed[tuple[str, ...]]], allowed.anything()] = ()
    """No option: those of `config` that the earlier run was not given but chose itself."""

    CHOSEN_FROM: ClassVar[Mapping[str, tuple[str, ...]]] = {}
    """Options that the program chooses where they are left open, and what it chooses each one by."""

    def check(self) -> None:
        """Raise InputError for the first option that is not allowed."""
        check(self)

    def split_over(self) -> tuple[str | None, int, int]:
        """Where the processes of the run meet (None: nowhere yet), how many there are, and which this is."""
        return None, 1, 0

    def without_effect(self) -> dict[str, str]:
        """Options that do nothing beside the others though they are set, and when they would do something."""
        return {}


@dataclasses.dataclass(frozen=True)
class Outcome:
    """What a command found.

    summary: the keys of summary.json that are the command's own, in order. tables: what a person reads on
    standard output. report: makes the page from the whole summary, None for a command without one. resolved:
    options that were left to the program, as it chose them; they go into the summary's config. failure: why
    the work as a whole failed though there are results, None for success. interrupted: a signal broke
    the work off, and these are the results so far.
    """

    summary: Mapping[str, Any]
    tables: tuple[Table, ...]
    report: Callable[[Mapping[str, Any]], "Page"] | None = None
    resolved: Mapping[str, Any] = dataclasses.field(default_factory=dict)
    failure: str | None = None
    interrupted: bool = False


@dataclasses.dataclass(frozen=True)
class Command:
    """One sub-command: its name, its options, and the work, which may write files into the run's folder.

    share: the work of a further process of a run that is split over several, which writes nothing.
    """

    name: str
    options: type[RunOptions]
    execute: Callable[[Any, RunFolder], Outcome]
    share: Callable[[Any], None] | None = None
