"""The elements of an SVG file, read by a parser that resolves no entity and opens no other file.

Every limit is checked while the file streams through expat, before anything is built from it.
"""

import stat
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from xml.parsers import expat

from jaxpaint.errors import InputError

MAX_BYTES = 20_000_000
MAX_ELEMENTS = 50_000
MAX_DEPTH = 100

_SVG = "http://www.w3.org/2000/svg"
_XLINK = "http://www.w3.org/1999/xlink"


@dataclass(eq=False)
class Element:
    """One element: name without namespace (empty for a foreign one), attributes, children, text of styles."""

    tag: str
    attributes: dict[str, str]
    children: list["Element"] = field(default_factory=list)
    text: str = ""

    def walk(self) -> Iterator["Element"]:
        """This element and all below it, in the order of the file."""
        stack: list[Element] = [self]
        while stack:
            element = stack.pop()
            yield element
            stack.extend(reversed(element.children))


def load_markup(path: Path) -> Element:
    """The root element of an SVG file. What is wrong with the file, if anything, is an InputError."""
    content = _read_bytes(path)
    builder = _Builder()
    try:
        builder.parser.Parse(content, True)
    except expat.ExpatError as error:
        reason = f"{expat.ErrorString(error.code)} in line {error.lineno}"
        raise InputError(
            f"found broken or truncated XML ({reason}); allowed is a complete SVG file"
        ) from None
    except (LookupError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"found an unknown text encoding ({error}); allowed are UTF-8 and UTF-16") from None
    assert builder.root is not None  # expat refuses a document without a root element
    return builder.root


def check_file(path: Path):
    """Only a regular file can be read; anything else, and no file at all, is an InputError."""
    try:
        mode = path.stat().st_mode
    except FileNotFoundError:
        raise InputError("no such file; allowed is an existing .svg file") from None
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror}); allowed is a readable .svg file") from None
    if stat.S_ISDIR(mode):
        raise InputError("found a folder; allowed is an .svg file")
    if not stat.S_ISREG(mode):
        raise InputError("found a device or a pipe; allowed is an .svg file")


def excerpt(text: str) -> str:
    """The beginning of a text on one line, for messages."""
    line = " ".join(text.split())
    return line if len(line) <= 40 else f"{line[:40]}..."


def _read_bytes(path: Path) -> bytes:
    """The whole file, if it is one of reasonable size."""
    check_file(path)
    try:
        with path.open("rb") as file:
            content = file.read(MAX_BYTES + 1)
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror}); allowed is a readable .svg file") from None
    if len(content) > MAX_BYTES:
        raise InputError(f"found more than {MAX_BYTES // 10**6} MB; allowed are smaller files")
    if not content.strip():
        raise InputError("found an empty file; allowed is an SVG file with something to draw")
    return content


class _Builder:
    """Handlers that turn expat's events into a tree and stop at the first thing that is not allowed."""

    def __init__(self):
        self.root: Element | None = None
        self._open: list[Element] = []
        self._count = 0
        self.parser = expat.ParserCreate(namespace_separator="}")
        self.parser.buffer_text = True
        # Defaults from ATTLIST declarations would let a small file grow without bound in memory.
        self.parser.specified_attributes = True
        self.parser.EntityDeclHandler = self._entity
        self.parser.StartElementHandler = self._start
        self.parser.EndElementHandler = self._end
        self.parser.CharacterDataHandler = self._text

    def _entity(self, name, is_parameter, value, base, system, public, notation):
        kind = "an external entity" if value is None else "an entity declaration"
        raise InputError(f"found {kind} ({excerpt(name)}); allowed are SVG files that declare no entities")

    def _start(self, name: str, attributes: dict[str, str]):
        element = Element(
            _local(name, _SVG), {_local(key, _XLINK): value for key, value in attributes.items()}
        )
        if self.root is None:
            _check_root(name, element)
            self.root = element
        self._count += 1
        if self._count > MAX_ELEMENTS or len(self._open) >= MAX_DEPTH:
            raise InputError(f"found too many elements; allowed are {MAX_ELEMENTS}, nested {MAX_DEPTH} deep")
        if self._open:
            self._open[-1].children.append(element)
        self._open.append(element)

    def _end(self, name: str):
        self._open.pop()

    def _text(self, text: str):
        if self._open[-1].tag == "style":
            self._open[-1].text += text


def _check_root(name: str, element: Element):
    if element.tag != "svg":
        raise InputError(
            f"found a root element <{excerpt(name.replace('}', ' '))}>; allowed is <svg> of {_SVG}"
        )


def _local(name: str, namespace: str) -> str:
    """The local part of a name in this namespace or in none; empty for other namespaces."""
    uri, _, local = name.rpartition("}")
    return local if uri in ("", namespace) else ""
