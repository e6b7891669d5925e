"""Vertices and faces of .ply files: ascii and binary of both byte orders, polygons of any size."""

import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int, Shaped

_NAMES = {
    "i1": ("char", "int8"),
    "u1": ("uchar", "uint8"),
    "i2": ("short", "int16"),
    "u2": ("ushort", "uint16"),
    "i4": ("int", "int32"),
    "u4": ("uint", "uint32"),
    "f4": ("float", "float32"),
    "f8": ("double", "float64"),
}
_TYPES = {name: kind for kind, names in _NAMES.items() for name in names}
_ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
_CORNERS = ("vertex_indices", "vertex_index")


@dataclass(frozen=True)
class _Property:
    """type: of its numbers. length: type of the number before a list, which says how many; "" for no list."""

    name: str
    type: str
    length: str


@dataclass(frozen=True)
class _Element:
    name: str
    count: int
    properties: tuple[_Property, ...]


@dataclass(frozen=True)
class _Body:
    """What follows the header, as cells: bytes, or in an ascii file (order "") numbers."""

    cells: Shaped[np.ndarray, "cells"]
    order: str

    def width(self, kind: str) -> int:
        """Cells of one number."""
        return np.dtype(kind).itemsize if self.order else 1

    def numbers(self, cells: Shaped[np.ndarray, "*s cells"], kind: str) -> Shaped[np.ndarray, "*s numbers"]:
        """What is in some cells."""
        return np.ascontiguousarray(cells).view(self.order + kind) if self.order else cells

    def length(self, at: int, kind: str) -> int:
        """The length of the list that begins at a cell."""
        found = float(self.numbers(self.cells[at : at + self.width(kind)], kind)[0])
        if not (found >= 0 and found.is_integer()):
            raise ValueError("the length of a list is 0, 1, 2, ...")
        return int(found)


def read_ply(
    path: Path,
) -> tuple[Float[np.ndarray, "V 3"], Int[np.ndarray, "C"], Int[np.ndarray, "P"]]:
    """Vertices, the corners of all polygons one after another, and how many corners each polygon has.

    Raises an Exception of some kind where the body is not what the header says.
    """
    elements, body = _opened(path.read_bytes())
    at, found = 0, {}
    for element in elements:
        columns, at = _columns(body, element, at)
        found[element.name] = columns
    points = np.stack([found["vertex"][axis][0] for axis in "xyz"], axis=-1).astype(float)
    corners, counts = next(found["face"][name] for name in _CORNERS if name in found["face"])
    if not np.array_equal(corners, np.rint(corners)):
        raise ValueError("a corner is no whole number")
    return points, corners.astype(np.int64), counts


def _opened(data: bytes) -> tuple[list[_Element], _Body]:
    end = data.index(b"end_header")
    start = data.index(b"\n", end) + 1
    order, elements = "", []
    for line in data[:end].decode("ascii", errors="replace").splitlines():
        words = line.split()
        if words[:1] == ["format"]:
            order = _ORDERS[words[1]]
        elif words[:1] == ["element"]:
            elements.append(_Element(words[1], int(words[2]), ()))
        elif words[:1] == ["property"]:
            length = _TYPES[words[2]] if words[1] == "list" else ""
            last, new = elements[-1], _Property(words[-1], _TYPES[words[-2]], length)
            elements[-1] = _Element(last.name, last.count, (*last.properties, new))
    return elements, _Body(
        np.frombuffer(data, np.uint8, offset=start) if order else _ascii(data, start), order
    )


def _ascii(data: bytes, start: int) -> np.ndarray:
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # of what is no number
        return np.fromstring(data[start:].decode("ascii"), dtype=float, sep=" ")


_Columns = dict[str, tuple[np.ndarray, np.ndarray]]


def _columns(body: _Body, element: _Element, at: int) -> tuple[_Columns, int]:
    """Of each property the numbers of all rows, and how many a row has; and where the next element begins."""
    if not element.count:
        return {p.name: (np.zeros(0), np.zeros(0, int)) for p in element.properties}, at
    found, width = _even(body, element, at)
    return (found, at + width) if found else _uneven(body, element, at)


def _even(body: _Body, element: _Element, at: int) -> tuple[_Columns, int]:
    """Columns where all rows are as long as the first, nothing where they are not."""
    places, sizes, end = _row(body, element, at)
    rows = body.cells[at : at + element.count * (end - at)]
    if len(rows) < element.count * (end - at):
        return {}, 0
    rows, found = rows.reshape(element.count, -1), {}
    for p, place, size in zip(element.properties, places, sizes, strict=True):
        first = place - at
        if p.length:
            lengths = body.numbers(rows[:, first - body.width(p.length) : first], p.length)
            if (lengths != size).any():
                return {}, 0
        numbers = body.numbers(rows[:, first : first + size * body.width(p.type)], p.type)
        found[p.name] = numbers.reshape(-1), np.full(element.count, size)
    return found, rows.size


def _uneven(body: _Body, element: _Element, at: int) -> tuple[_Columns, int]:
    """Columns row by row."""
    rows = []
    for _ in range(element.count):
        places, sizes, at = _row(body, element, at)
        rows.append((places, sizes))
    if at > len(body.cells):
        raise ValueError("the file is cut short")
    places, counts = (np.array([row[k] for row in rows]).T for k in (0, 1))
    found = {}
    for p, place, count in zip(element.properties, places, counts, strict=True):
        nth = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
        first = np.repeat(place, count) + nth * body.width(p.type)
        cells = body.cells[first[:, None] + np.arange(body.width(p.type))]
        found[p.name] = body.numbers(cells, p.type).reshape(-1), count
    return found, at


def _row(body: _Body, element: _Element, at: int) -> tuple[list[int], list[int], int]:
    """Where the numbers of each property begin in the row that begins at a cell, how many, where it ends."""
    places, sizes = [], []
    for p in element.properties:
        size = 1
        if p.length:
            size = body.length(at, p.length)
            at += body.width(p.length)
        places.append(at)
        sizes.append(size)
        at += size * body.width(p.type)
    return places, sizes, at
