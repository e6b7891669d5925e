"""Vertices and faces of .obj files."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from jaxpaint.errors import InputError
from sims.scenes.polygons import cut

_PIECE = 1 << 20


def read_obj(path: Path) -> tuple[Float[np.ndarray, "V 3"], Int[np.ndarray, "F 3"]]:
    """All vertices and triangles of a file, whatever groups they are in. Raises InputError for other text."""
    vertices: list[list[float]] = []
    polygons: list[list[int]] = []
    for number, words in _lines(path):
        try:
            if words[0] == "v":
                vertices.append([float(word) for word in words[1:4]])
            elif words[0] == "f":
                polygons.append([_index(word, len(vertices)) for word in words[1:]])
        except ValueError as error:
            raise InputError(
                f"{path}: line {number}: '{' '.join(words)[:60]}' is no {words[0]} line"
            ) from error
    if any(len(vertex) < 3 for vertex in vertices):
        raise InputError(f"{path}: a vertex with fewer than three numbers found")
    points = np.asarray(vertices, dtype=float).reshape(-1, 3)
    corners = np.fromiter((corner for polygon in polygons for corner in polygon), dtype=np.int64)
    if len(corners) and (corners.min() < 0 or corners.max() >= len(points)):
        raise InputError(f"{path}: faces name vertices that are not there ({len(points)} vertices found)")
    return points, cut(points, corners, np.array([len(polygon) for polygon in polygons], dtype=np.int64))


def count_obj(path: Path, limit: int) -> int:
    """How many triangles a file holds, or would hold if each had three corners of its own: at most about
    `limit`. Only a piece of the file is held at a time.
    """
    triangles = vertices = corners = 0
    kind = b""
    with path.open("rb") as file:
        while max(triangles, vertices // 3) <= limit and (line := file.readline(_PIECE)):
            text = line.split(b"#", 1)[0].rstrip()
            words = text.rstrip(b"\\").split()
            if not kind and words:
                kind, words = words[0], words[1:]
            corners += len(words)
            if not text.endswith(b"\\") and line.endswith(b"\n"):
                vertices += kind == b"v"
                triangles += max(corners - 2, 0) if kind == b"f" else 0
                kind, corners = b"", 0
    return max(triangles + max(corners - 2, 0) * (kind == b"f"), vertices // 3)


def _lines(path: Path) -> Iterator[tuple[int, list[str]]]:
    """Words of each line that has some, with its number; lines that end in a backslash go on."""
    held: list[str] = []
    with path.open("r", encoding="utf-8", errors="replace") as file:
        for number, line in enumerate(file, start=1):
            line = line.split("#", 1)[0].rstrip()
            held += line.rstrip("\\").split()
            if held and not line.endswith("\\"):
                yield number, held
                held = []
    if held:
        yield -1, held


def _index(word: str, count: int) -> int:
    """From 1, or backwards from the last vertex so far; what follows a slash is no position."""
    index = int(word.split("/", 1)[0])
    if index == 0:
        raise ValueError("indices begin at 1")
    return index - 1 if index > 0 else count + index
