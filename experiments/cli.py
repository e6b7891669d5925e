"""The program `jaxpaint`: sub-commands, one line for every error, exit status 0, 1, 2 (130: Ctrl-C)."""

import contextlib
import difflib
import io
import os
import re
import sys
import warnings
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, NoReturn, Union

from experiments import process
from experiments.commands import MODULES, Command, find
from experiments.interrupts import INTERRUPTED, held
from experiments.options import from_config, option_names, refuse, repeated, required, values_of
from experiments.output import describe_versions, read_summary
from experiments.processes import Peers, PeersLost, joined, launch, left_open
from jaxpaint.errors import InputError

PROGRAM = "jaxpaint"
ABOUT = "Simulate and optimise wall-painting mobile manipulators, many worlds at once."
TRACEBACK_VARIABLE = "JAXPAINT_TRACEBACK"


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command line and return its exit status; the process is set up only where argv is None."""
    status = _run(sys.argv[1:] if argv is None else list(argv), owns_process=argv is None)
    if argv is None and left_open():
        sys.stdout.flush()
        os._exit(status)  # an orderly end would wait for processes that are gone
    return status


def _run(words: list[str], owns_process: bool) -> int:
    try:
        if owns_process:
            process.prepare_python()
        status = _dispatch(words, owns_process)
        sys.stdout.flush()
        return status
    except InputError as error:
        return _complain(str(error), 2)
    except KeyboardInterrupt as signal:
        return _complain("interrupted; nothing was written", getattr(signal, "status", INTERRUPTED))
    except BrokenPipeError:
        # Nobody reads standard output any more; the results are in their folder.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except PeersLost as error:
        return _complain(f"failed: {error}", 1)
    except Exception as error:
        if os.environ.get(TRACEBACK_VARIABLE):
            raise
        reason = f"{type(error).__name__}: {error}"
        return _complain(f"failed: {reason} (set {TRACEBACK_VARIABLE}=1 to see where)", 1)


def _dispatch(words: list[str], owns_process: bool) -> int:
    if not words:
        raise InputError(f"command: found none, allowed: {', '.join(MODULES)}")
    if words[0] in ("--help", "-h"):
        return _help()
    if words[0] == "--version":
        print(f"{PROGRAM} {describe_versions()['jaxpaint'] or '(not installed)'}")
        return 0
    if words[0] not in MODULES:
        raise InputError(f"command: found {words[0]!r}, allowed: {', '.join(MODULES)}")
    command = find(words[0])
    options = parse(command, words[1:])
    if options is None:
        return 0
    options.check()
    coordinator, count, number = options.split_over()
    if count > 1 and coordinator is None:
        return launch(words, count, options.out)
    if owns_process:
        process.prepare_jax()
    with joined(coordinator, count, number) as peers:
        if number and command.share is not None:
            return _help_out(command.share, options, peers)
        from experiments.commands.running import run

        return run(command, options)


def _help_out(share: Callable[[Any], None], options: Any, peers: Peers) -> int:
    """The work of a further process: a first signal ends it with what it has finished."""
    with held() as interrupts:
        interrupts.keep()
        share(options)
        peers.wait_for_the_end()
    return 0


def parse(command: Command, words: list[str]) -> Any:
    """The command's options from words; None where help was asked for and given."""
    import tyro

    earlier = _earlier(command, words)
    said = io.StringIO()
    try:
        with contextlib.redirect_stderr(said), warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of defaults from a config, which are checked later
            options, unknown = tyro.cli(
                command.options,
                prog=f"{PROGRAM} {command.name}",
                args=_with_signs(command, words),
                default=tyro.MISSING_NONPROP if earlier is None else earlier,
                return_unknown_args=True,
            )
    except SystemExit as leaving:
        if leaving.code in (0, None):
            return None
        _refuse_box(command, said.getvalue())
    if unknown:
        _refuse_unknown(command, unknown)
    return options if earlier is None else repeated(options, earlier, _given(command, words))


def _with_signs(command: Command, words: list[str]) -> list[str]:
    """`--up -y` as `--up=-y`: a value with a sign is told from an option only by who knows both."""
    known = {name: values_of(command.options)[field] for field, name in option_names(command.options).items()}
    joined: list[str] = []
    for word in words:
        values = known.get(joined[-1]) if joined else None
        if values is not None and word[:1] == "-" and values.nargs == 1 and values.holds(word):
            joined[-1] += f"={word}"
        else:
            joined.append(word)
    return joined


def _earlier(command: Command, words: list[str]) -> Any:
    """The options of the run that `--config` names, None without one."""
    path = _value_after("--config", words)
    if path is None:
        return None
    summary = read_summary(Path(path), command.name)
    remark, chosen = _other_version(summary), summary.get("chosen", ())
    return from_config(command.options, summary["config"], path, remark, chosen)


def _given(command: Command, words: list[str]) -> set[str]:
    """Fields that a command line names; a flag also by its `--no-`. All that has no name of its own is."""
    said = {word.partition("=")[0].replace("_", "-") for word in words if word.startswith("--")}
    names = option_names(command.options)
    return {
        field
        for field, name in names.items()
        if name in said or name.replace("--", "--no-", 1) in said or not name.startswith("--")
    }


def _other_version(summary: Mapping[str, Any]) -> str:
    """By which version of the program a summary was written, where that is not this one."""
    versions = summary.get("versions")
    theirs = versions.get("jaxpaint") if isinstance(versions, Mapping) else None
    if theirs is None or theirs == describe_versions()["jaxpaint"]:
        return ""
    return f"written by {PROGRAM} {theirs}"


def _value_after(name: str, words: list[str]) -> str | None:
    found = None
    for index, word in enumerate(words):
        if word.startswith(f"{name}="):
            found = word.partition("=")[2]
        elif word == name and index + 1 < len(words):
            found = words[index + 1]
    return found


def _refuse_unknown(command: Command, unknown: list[str]) -> NoReturn:
    names = list(option_names(command.options).values())
    found = unknown[0].partition("=")[0]
    near = difflib.get_close_matches(found, names, n=2)
    allowed = f"{' or '.join(near)}, perhaps" if near else f"what '{PROGRAM} {command.name} --help' says"
    refuse(command.name, found, allowed)


def _refuse_box(command: Command, box: str) -> NoReturn:
    """The error of tyro's box in our own line: an option without its values, or else the message as it is."""
    message = " ".join(re.sub("[─│╭╮╰╯]|--{2,}", " ", box).split()).partition(" For full helptext")[0]
    names, values = option_names(command.options), values_of(command.options)
    said = [field for field, name in names.items() if re.search(rf"(?<![\w-]){name}(?![\w-])", message)]
    for field in [*said, *sorted(required(command.options))]:
        known = values[field]
        if known is not None:
            raise InputError(f"{names[field]}: found too few values, allowed: {known.allowed}")
    raise InputError(message or f"{command.name}: bad usage")


def _help() -> int:
    """The program's own help: every command with its first line."""
    import tyro

    kinds = tuple(
        Annotated[find(name).options, tyro.conf.subcommand(name, prefix_name=False)] for name in MODULES
    )
    commands: Any = Union[kinds]  # noqa: UP007
    with contextlib.suppress(SystemExit):
        tyro.cli(commands, prog=PROGRAM, description=ABOUT, args=["--help"])
    return 0


def _complain(message: str, status: int) -> int:
    """One line on standard error."""
    line = " ".join(message.split())
    print(f"{PROGRAM}: {line}", file=sys.stderr, flush=True)
    return status
