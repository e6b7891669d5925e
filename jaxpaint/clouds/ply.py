"""Reader of the vertices of .ply files: ascii and binary of both byte orders."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jaxpaint.clouds.records import Records
from jaxpaint.errors import InputError

_TYPES = {
    "char": "i1",
    "int8": "i1",
    "uchar": "u1",
    "uint8": "u1",
    "short": "i2",
    "int16": "i2",
    "ushort": "u2",
    "uint16": "u2",
    "int": "i4",
    "int32": "i4",
    "uint": "u4",
    "uint32": "u4",
    "float": "f4",
    "float32": "f4",
    "double": "f8",
    "float64": "f8",
}
_ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}


@dataclass(frozen=True)
class _Header:
    """Where the vertices lie: format, count, names and types of their properties, bytes before the body."""

    format: str
    count: int
    properties: tuple[tuple[str, str], ...]
    start: int


def read_ply(path: Path) -> Records:
    """The vertices of a .ply file, faces left aside. Raises InputError where it is none or is cut short."""
    data = path.read_bytes()
    header = _header(path, data)
    names = [name for name, _ in header.properties]
    if not {"x", "y", "z"} <= set(names):
        raise InputError(f"{path}: vertex properties {', '.join(names)} found, x, y and z are needed")
    rows = _ascii_rows(path, data, header) if header.format == "ascii" else _binary_rows(path, data, header)
    channels = [("red", "green", "blue"), ("r", "g", "b"), ("diffuse_red", "diffuse_green", "diffuse_blue")]
    colour = next((triple for triple in channels if set(triple) <= set(names)), None)
    return Records.of(
        np.stack([rows[axis] for axis in "xyz"], axis=-1),
        colours=None if colour is None else np.stack([rows[channel] for channel in colour], axis=-1),
    )


def _header(path: Path, data: bytes) -> _Header:
    end = data.find(b"end_header")
    if not data.startswith(b"ply") or end < 0:
        raise InputError(f"{path}: no .ply header (ply ... end_header) found")
    start = data.find(b"\n", end) + 1 or len(data)
    lines = [line.split() for line in data[:end].decode("ascii", errors="replace").splitlines()]
    form = next((line[1] for line in lines if line[:1] == ["format"]), "")
    elements = [line for line in lines if line[:1] == ["element"]]
    if form not in _ORDERS or not elements or elements[0][1] != "vertex":
        raise InputError(f"{path}: a .ply of a kind that is not read (vertices first, {', '.join(_ORDERS)})")
    return _Header(form, int(elements[0][2]), _vertex_properties(path, lines), start)


def _vertex_properties(path: Path, lines: list[list[str]]) -> tuple[tuple[str, str], ...]:
    properties = []
    for line in lines[1 + next(i for i, line in enumerate(lines) if line[:2] == ["element", "vertex"]) :]:
        if line[:1] == ["element"]:
            break
        if line[:1] == ["property"]:
            if line[1] not in _TYPES:
                raise InputError(f"{path}: vertex property of type '{line[1]}', allowed: {', '.join(_TYPES)}")
            properties.append((line[2], _TYPES[line[1]]))
    return tuple(properties)


def _binary_rows(path: Path, data: bytes, header: _Header) -> np.ndarray:
    order = _ORDERS[header.format]
    layout = np.dtype([(name, order + kind) for name, kind in header.properties])
    found = (len(data) - header.start) // layout.itemsize
    if found < header.count:
        raise InputError(f"{path}: cut short, {found} points found where the header says {header.count}")
    return np.frombuffer(data, dtype=layout, count=header.count, offset=header.start)


def _ascii_rows(path: Path, data: bytes, header: _Header) -> dict[str, np.ndarray]:
    lines = data[header.start :].decode("ascii", errors="replace").splitlines()[: header.count]
    if len(lines) < header.count:
        raise InputError(f"{path}: cut short, {len(lines)} points found where the header says {header.count}")
    try:
        table = np.loadtxt(lines, ndmin=2) if lines else np.zeros((0, len(header.properties)))
        return {name: table[:, column].astype(kind) for column, (name, kind) in enumerate(header.properties)}
    except (ValueError, IndexError) as error:
        raise InputError(f"{path}: the rows of the body do not fit the .ply header") from error
