"""One run of a command, from checked options to a folder that is whole."""

import sys
import time
from collections.abc import Mapping
from typing import Any

from experiments import tables
from experiments.commands.command import Command, Outcome, RunOptions
from experiments.compile_clock import CompileClock
from experiments.interrupts import INTERRUPTED, held
from experiments.options import defaults_of, to_config
from experiments.output import RunFolder, describe_device, describe_versions, write_json
from experiments.report import render


def run(command: Command, options: RunOptions) -> int:
    """Do the work, write its folder, show its tables; exit status 0, or 1 where the work says that it failed.

    InputError and every other exception pass through, and then nothing was written. After a signal, what the
    work kept is written like the rest, and the exit status is the signal's.
    """
    options.check()
    saved, stopped = False, None
    try:
        with held() as interrupts:
            with RunFolder(command.name, options.out, options.overwrite) as folder:
                start = time.perf_counter()
                with CompileClock() as clock:
                    outcome = command.execute(options, folder)
                interrupts.keep()
                seconds = time.perf_counter() - start
                summary = _summary(command, options, outcome, clock.seconds, seconds)
                _write(folder, summary, outcome)
            saved, stopped = True, interrupts.status
        _show(command, folder, outcome)
    except KeyboardInterrupt as signal:
        if not saved:
            raise
        # Nothing is lost any more: who stops the printing is told the same as who came before it.
        stopped = stopped or getattr(signal, "status", INTERRUPTED)
    if stopped is not None:
        _say(
            command,
            "interrupted; what was finished is saved" if outcome.interrupted else "interrupted; all is saved",
        )
        return stopped
    return 0 if outcome.failure is None else 1


def _summary(
    command: Command, options: RunOptions, outcome: Outcome, compile_s: float, seconds: float
) -> dict[str, Any]:
    """The keys that every command has, then its own."""
    return {
        "command": command.name,
        "config": {**to_config(options), **outcome.resolved},
        "seed": options.seed,
        "versions": describe_versions(),
        "device": describe_device(),
        "compile_s": compile_s,
        "run_s": seconds - compile_s,
        **({"chosen": chosen_options(options, outcome.resolved)} if options.CHOSEN_FROM else {}),
        **outcome.summary,
        **({"interrupted": True} if outcome.interrupted else {}),
    }


def chosen_options(options: RunOptions, resolved: Mapping[str, Any]) -> list[str]:
    """Options of the config that nobody gave: the program chose them, now or in the run that is repeated."""
    defaults = defaults_of(type(options))
    now = {name for name in resolved if getattr(options, name) == defaults[name]}
    return [name for name in defaults if name in now or name in options.chosen]


def _write(folder: RunFolder, summary: Mapping[str, Any], outcome: Outcome) -> None:
    if outcome.report is not None:
        folder.path("report.html").write_text(render(outcome.report(summary)), encoding="utf-8")
    write_json(folder.path("summary.json"), {**summary, "files": [*folder.files(), "summary.json"]})


def _show(command: Command, folder: RunFolder, outcome: Outcome) -> None:
    tables.show(outcome.tables)
    names = [name for name in ("report.html", "summary.json") if (folder.final / name).exists()]
    print("\n".join(str(folder.final / name) for name in names), flush=True)
    if outcome.failure is not None:
        _say(command, f"failed: {outcome.failure}")


def _say(command: Command, message: str) -> None:
    """One line on standard error."""
    print(f"jaxpaint {command.name}: {message}", file=sys.stderr, flush=True)
