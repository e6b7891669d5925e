"""Options of a command: a frozen dataclass whose fields are annotated with `experiments.values.Values`.

The command line, a repeated `summary.json` and a caller in Python all pass the same `check`.
"""

import dataclasses
import typing
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NoReturn, TypeVar

from tyro.conf import Positional

from experiments.values import Values
from jaxpaint.errors import InputError

Options = TypeVar("Options")

NOT_REPEATED = ("out", "overwrite", "config")
"""Options that say where one run goes; `--config` takes them from the command line alone."""

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


def check(options: Any) -> None:
    """Raise InputError for the first value that is not allowed; None is, where it is the default."""
    defaults = {field.name: field.default for field in dataclasses.fields(options)}
    names = option_names(type(options))
    for field, values in values_of(type(options)).items():
        value = getattr(options, field)
        if value is None and defaults[field] is None:
            continue
        if values is None:
            if not isinstance(value, bool):
                refuse(names[field], value, "true or false")
        elif not values.holds(value):
            refuse(names[field], value, values.allowed, values.remark(value))


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
    options_type: type[Options], config: Mapping[str, Any], source: str, remark: str = ""
) -> Options:
    """Options from the `config` of an earlier `summary.json`, called `source` in errors; not checked here.

    remark: why an unknown option may be there.
    """
    known = {name: values for name, values in values_of(options_type).items() if name not in NOT_REPEATED}
    unknown = sorted(set(config) - set(known) - set(NOT_REPEATED))
    if unknown:
        refuse(f"{source}: config", unknown[0], ", ".join(known), remark)
    missing = sorted(required(options_type) - set(config))
    if missing:
        refuse(f"{source}: config", f"no {missing[0]}", f"all of {', '.join(sorted(required(options_type)))}")
    given = {name: _restored(values, config[name]) for name, values in known.items() if name in config}
    return options_type(**given)


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
