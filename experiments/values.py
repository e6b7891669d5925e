"""What one option of a command may be: how it is read from text, what is allowed, and that in words."""

import dataclasses
import math
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from tyro.constructors import PrimitiveConstructorSpec


@dataclasses.dataclass(frozen=True)
class Values(PrimitiveConstructorSpec[Any]):
    """The values an option may take; stands in the annotation of the option's field.

    holds: is this value allowed? allowed: the same in words. restore: the value from its JSON form.
    remark: why a value that is not allowed is not, where that says more than the value itself.
    Text that cannot be read stays text: `experiments.options.check` names the option, which a reader cannot.
    """

    holds: Callable[[Any], bool] = lambda value: True
    allowed: str = "anything"
    restore: Callable[[Any], Any] = lambda value: value
    remark: Callable[[Any], str] = lambda value: ""


def number(
    metavar: str,
    *,
    above: float | None = None,
    at_least: float | None = None,
    at_most: float | None = None,
    count: int = 1,
    unset: str = "none",
) -> Values:
    """`count` finite numbers inside bounds; `metavar` shows the units, `unset` words a default of None."""

    def inside(value: Any) -> bool:
        known = isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
        return known and _inside(value, above, at_least, at_most)

    return _words(_as_float, inside, f"a number{_bounds(above, at_least, at_most)}", metavar, count, unset)


def whole(
    metavar: str, *, at_least: int, at_most: int | None = None, count: int = 1, unset: str = "none"
) -> Values:
    """`count` whole numbers inside bounds; `unset` words a default of None."""

    def inside(value: Any) -> bool:
        known = isinstance(value, int) and not isinstance(value, bool)
        return known and _inside(value, None, at_least, at_most)

    allowed = f"a whole number{_bounds(None, at_least, at_most)}"
    return _words(_as_int, inside, allowed, metavar, count, unset)


def choice(*names: str, later: Iterable[str] = (), unset: str = "none") -> Values:
    """One of `names`; those in `later` are known, and refused as not built yet."""
    refused = tuple(later)
    metavar = "{" + ",".join((*names, *refused)) + "}"
    allowed = ", ".join(names) + _not_yet(refused)
    return _words(str, lambda value: value in names, allowed, metavar, unset=unset)


def text(metavar: str, *, unset: str = "none") -> Values:
    """Any text but none at all: what it may be is known only to the command itself."""
    return _words(
        str, lambda value: isinstance(value, str) and value != "", "some text", metavar, unset=unset
    )


def file(*suffixes: str, later: Iterable[str] = (), unset: str = "none") -> Values:
    """An existing file whose name ends in one of `suffixes`."""
    allowed = f"an existing file ({' '.join(suffixes)})" + _not_yet(tuple(later))
    values = _words(_as_path, lambda value: _is_file(value, suffixes), allowed, "FILE", unset=unset)
    return dataclasses.replace(values, restore=_from_json(()), remark=_why_no_file)


def name_or_file(names: tuple[str, ...], suffixes: tuple[str, ...], later: Iterable[str] = ()) -> Values:
    """One of `names` (text), or an existing file (a Path)."""

    def read(word: str) -> str | Path:
        return word if word in names else _as_path(word)

    allowed = f"{', '.join(names)}, or an existing file ({' '.join(suffixes)})" + _not_yet(tuple(later))
    values = _words(
        read,
        lambda value: value in names or _is_file(value, suffixes),
        allowed,
        f"{{{','.join(names)}}}|FILE",
    )
    return dataclasses.replace(values, restore=_from_json(names), remark=_why_no_file)


def address(*, unset: str) -> Values:
    """A host and a port."""

    def holds(value: Any) -> bool:
        host, _, port = value.rpartition(":") if isinstance(value, str) else ("", "", "")
        return host != "" and port.isascii() and port.isdigit() and 0 < int(port) < 65536

    return _words(str, holds, "HOST:PORT, the port from 1 to 65535", "HOST:PORT", unset=unset)


def anything() -> Values:
    """Any one word: for what the program alone sets."""
    return _words(str, lambda value: True, "anything", "VALUE")


def several(*names: str) -> Values:
    """Any of `names`, each at most once, in a tuple; `none` for the empty one."""
    one = choice(*names)

    def from_words(words: list[str]) -> tuple[str, ...] | str:
        if words == ["none"]:
            return ()
        return tuple(words) or "nothing"  # which is not allowed: an option without its values

    def hold(value: Any) -> bool:
        known = isinstance(value, tuple) and all(entry in names for entry in value)
        return known and len(set(value)) == len(value)

    return dataclasses.replace(
        one,
        nargs="*",
        metavar="{" + ",".join((*names, "none")) + "}",
        instance_from_str=from_words,
        str_from_instance=lambda value: list(value) or ["none"],
        holds=hold,
        allowed=f"none, or one or more of {', '.join(names)}, each once",
    )


def indices(metavar: str) -> Values:
    """Whole numbers from 0 on, each at most once, in a tuple; `none` for the empty one."""
    one = whole(metavar, at_least=0)

    def from_words(words: list[str]) -> tuple[Any, ...] | str:
        if words == ["none"]:
            return ()
        return tuple(_as_int(word) for word in words) or "nothing"  # which is not allowed

    def hold(value: Any) -> bool:
        known = isinstance(value, tuple) and all(one.holds(entry) for entry in value)
        return known and len(set(value)) == len(value)

    return dataclasses.replace(
        one,
        nargs="*",
        metavar=f"{metavar} [{metavar} ...]",
        instance_from_str=from_words,
        str_from_instance=lambda value: [str(entry) for entry in value] or ["none"],
        holds=hold,
        allowed="none, or one or more whole numbers of 0 or more, each once",
    )


def earlier_run(metavar: str) -> Values:
    """The folder of an earlier run, or its summary.json; read by `experiments.comparison.read_run`."""
    allowed = "the folder of an earlier run, or its summary.json"
    return _words(_as_path, lambda value: isinstance(value, Path), allowed, metavar)


def folder(*, unset: str) -> Values:
    """A folder to write into; `RunFolder` judges it."""
    return _words(_as_path, lambda value: isinstance(value, Path), "a folder", "DIR", unset=unset)


def data_folder(*, unset: str) -> Values:
    """An existing folder, to read from."""

    def holds(value: Any) -> bool:
        try:
            return isinstance(value, Path) and value.is_dir()
        except (OSError, ValueError):  # a name that no folder can have: too long, or with a null byte
            return False

    values = _words(_as_path, holds, "an existing folder", "DIR", unset=unset)
    return dataclasses.replace(values, restore=_from_json(()), remark=_why_no_file)


def _words(
    read: Callable[[str], Any],
    holds: Callable[[Any], bool],
    allowed: str,
    metavar: str,
    count: int = 1,
    unset: str = "none",
) -> Values:
    """Values of `count` alike words: a scalar for one, a tuple for more."""

    def from_words(words: list[str]) -> Any:
        return read(words[0]) if count == 1 else tuple(read(word) for word in words)

    def to_words(value: Any) -> list[str]:
        if value is None:
            return unset.split()
        return [str(value)] if count == 1 else [str(entry) for entry in value]

    def all_hold(value: Any) -> bool:
        return isinstance(value, tuple) and len(value) == count and all(holds(entry) for entry in value)

    return Values(
        nargs=count,
        metavar=metavar,
        instance_from_str=from_words,
        is_instance=lambda value: True,
        str_from_instance=to_words,
        holds=holds if count == 1 else all_hold,
        allowed=allowed if count == 1 else f"{count} values, each {allowed}",
    )


def _is_file(value: Any, suffixes: tuple[str, ...]) -> bool:
    """Is there a file of this name, and does the name end as it should?"""
    try:
        return isinstance(value, Path) and value.suffix.lower() in suffixes and value.is_file()
    except (OSError, ValueError):  # a name that no file can have: too long, or with a null byte
        return False


def _why_no_file(value: Any) -> str:
    try:
        found = isinstance(value, Path) and value.exists()
    except (OSError, ValueError):
        found = False
    return "" if found else "no such file"


def _from_json(names: tuple[str, ...]) -> Callable[[Any], Any]:
    return lambda value: Path(value) if isinstance(value, str) and value not in names else value


def _as_float(word: str) -> float | str:
    try:
        return float(word)
    except ValueError:
        return word


def _as_int(word: str) -> int | str:
    try:
        return int(word)
    except ValueError:
        return word


def _as_path(word: str) -> Path | str:
    """A path; no text at all stays text, which `Path` would take for the folder one is in."""
    return Path(word) if word else word


def _inside(value: float, above: float | None, at_least: float | None, at_most: float | None) -> bool:
    return (
        (above is None or value > above)
        and (at_least is None or value >= at_least)
        and (at_most is None or value <= at_most)
    )


def _bounds(above: float | None, at_least: float | None, at_most: float | None) -> str:
    if at_least is not None and at_most is not None:
        return f" from {at_least} to {at_most}"
    parts = (("above {:g}", above), ("of {} or more", at_least), ("of {} or less", at_most))
    words = [word.format(bound) for word, bound in parts if bound is not None]
    return f" {' and '.join(words)}" if words else ""


def _not_yet(names: tuple[str, ...]) -> str:
    return f" ({', '.join(names)}: not built yet)" if names else ""
