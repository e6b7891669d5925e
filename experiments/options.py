"""Options of a command: a frozen dataclass whose fields are annotated with `experiments.values.Values`.

The command line, a repeated `summary.json` and a caller in Python all pass the same `check`.
"""

import dataclasses
import typing
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any, NoReturn, TypeVar

from tyro.conf import Positional

from experiments.values import Values
from jaxpaint.errors import InputError

Options = TypeVar("Options")

NOT_REPEATED = (
    "out", "overwrite", "config", "chosen", "memory_gb", "processes", "coordinator", "process",
)  # fmt: skip
"""Options that say where one run goes, and on what it runs, which changes no figure; `--config` takes them
from the command line alone."""

_POSITIONAL = typing.get_args(Positional[int])[1]


def values_of(options_type: type) -> dict[str, Values | None]:
    """The `Values` of each field; None for a plain flag."""
    return {
        name: next((entry for entry in annotations if isinstance(entry, Values)), None)
        for name, annotations in _annotations(options_type).items()
    }


def option_names(options_type: type) -> dict[str, str]:
    """How the command line calls each field."""
    return {
        name: name.upper() if _POSITIONAL in annotations else "--" + name.replace("_", "-")
        for name, annotations in _annotations(options_type).items()
    }


def required(options_type: type) -> set[str]:
    """Fields without a default."""
    fields = dataclasses.fields(options_type)
    return {field.name for field in fields if field.default is dataclasses.MISSING}


def defaults_of(options_type: type) -> dict[str, Any]:
    """The default of each field that has one."""
    fields = dataclasses.fields(options_type)
    return {field.name: field.default for field in fields if field.default is not dataclasses.MISSING}


def check(options: Any) -> None:
    """Raise InputError for the first value that is not allowed; None is, where it is the default."""
    names = option_names(type(options))
    for field, values in values_of(type(options)).items():
        value = getattr(options, field)
        if is_allowed(options, field, value):
            continue
        if values is None:
            refuse(names[field], value, "true or false")
        refuse(names[field], value, values.allowed, values.remark(value))


def is_allowed(options: Any, field: str, value: Any) -> bool:
    """Whether an option may have this value, whatever the others are."""
    if value is None and defaults_of(type(options)).get(field, ...) is None:
        return True
    values = values_of(type(options))[field]
    return isinstance(value, bool) if values is None else values.holds(value)


def refuse(name: str, found: Any, allowed: str, remark: str = "") -> NoReturn:
    """The one line of every bad option."""
    shown = " ".join(str(entry) for entry in found) if isinstance(found, tuple) else str(found)
    raise InputError(f"{name}: found {shown!r}{f' ({remark})' if remark else ''}, allowed: {allowed}")


def to_config(options: Any) -> dict[str, Any]:
    """Options as JSON values: files by their full names, so that a repeat works from any folder."""
    return {
        field.name: _jsonable(getattr(options, field.name))
        for field in dataclasses.fields(options)
        if field.name not in NOT_REPEATED
    }


def from_config(
    options_type: type[Options],
    config: Mapping[str, Any],
    source: str,
    remark: str = "",
    chosen: Any = (),
) -> Options:
    """Options from the `config` of an earlier `summary.json`, called `source` in errors; not checked here.

    remark: why an unknown option may be there. chosen: the summary's list of options that the earlier run
    chose itself.
    """
    known = {name: values for name, values in values_of(options_type).items() if name not in NOT_REPEATED}
    unknown = sorted(set(config) - set(known) - set(NOT_REPEATED))
    if unknown:
        refuse(f"{source}: config", unknown[0], ", ".join(known), remark)
    missing = sorted(required(options_type) - set(config))
    if missing:
        refuse(f"{source}: config", f"no {missing[0]}", f"all of {', '.join(sorted(required(options_type)))}")
    given = {name: _restored(values, config[name]) for name, values in known.items() if name in config}
    may_choose: Any = getattr(options_type, "CHOSEN_FROM", {})
    listed = list(chosen) if isinstance(chosen, list | tuple) else [chosen]
    strange = [name for name in listed if not isinstance(name, str) or name not in may_choose]
    if strange:
        refuse(f"{source}: chosen", strange[0], f"a list of {', '.join(may_choose) or 'nothing'}", remark)
    return options_type(**given, **({"chosen": tuple(listed)} if listed else {}))


def repeated(options: Options, earlier: Any, given: Collection[str]) -> Options:
    """The options of a repeat, of which `given` were given on the command line and the others come from
    `earlier`: without what that run chose by options that are others now, and without what has no effect
    beside those given.
    """
    defaults, first = defaults_of(type(options)), vars(options)
    kept = [name for name in earlier.chosen if name not in given]
    stale = {
        name
        for name in kept
        if any(first[other] != getattr(earlier, other) for other in earlier.CHOSEN_FROM[name])
    }
    chosen = tuple(name for name in kept if name not in stale)
    fresh: Any = dataclasses.replace(options, chosen=chosen, **{name: defaults[name] for name in stale})  # pyright: ignore
    idle = set(fresh.without_effect()) - set(given)
    return dataclasses.replace(fresh, **{name: defaults[name] for name in idle})


def _annotations(options_type: type) -> dict[str, tuple[Any, ...]]:
    hints = typing.get_type_hints(options_type, include_extras=True)
    return {
        field.name: getattr(hints[field.name], "__metadata__", ())
        for field in dataclasses.fields(options_type)
    }


def _restored(values: Values | None, value: Any) -> Any:
    if isinstance(value, list):
        value = tuple(value)
    return value if values is None else values.restore(value)


def _jsonable(value: Any) -> Any:
    if isinstance(value, Path):
        return str(value.absolute())
    return list(value) if isinstance(value, tuple) else value
