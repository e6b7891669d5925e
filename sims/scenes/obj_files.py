"""Vertices and faces of .obj files; polygons of any shape are cut into triangles that do not overlap.

Fans, into which polygons are usually cut, fill what a polygon leaves open: a door becomes wall.
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from jaxpaint.errors import InputError


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
    if any(max(polygon, default=0) >= len(points) or min(polygon, default=0) < 0 for polygon in polygons):
        raise InputError(f"{path}: faces name vertices that are not there ({len(points)} vertices found)")
    triangles = [part for polygon in polygons for part in triangulate(points, polygon)]
    return points, np.asarray(triangles, dtype=np.int64).reshape(-1, 3)


def triangulate(points: Float[np.ndarray, "V 3"], polygon: list[int]) -> list[tuple[int, int, int]]:
    """A polygon, concave as it may be, as triangles of the same turn: ears are cut off one by one.

    polygon: indices of its corners in order. A polygon that encloses a hole by a seam is allowed.
    """
    if len(polygon) < 3:
        return []
    if len(polygon) == 3:
        return [(polygon[0], polygon[1], polygon[2])]
    flat = _flattened(points[polygon])
    left, found = list(range(len(polygon))), []
    while len(left) > 3:
        ear = next((k for k in range(len(left)) if _is_ear(flat, left, k)), None)
        if ear is None:
            # Nothing sound is left of a polygon that crosses itself; flat corners are only passed over.
            ear = int(np.argmin([abs(_turn(flat, left, k)) for k in range(len(left))]))
        found.append((left[ear - 1], left[ear], left[(ear + 1) % len(left)]))
        del left[ear]
    found.append((left[0], left[1], left[2]))
    return [(polygon[a], polygon[b], polygon[c]) for a, b, c in found]


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


def _flattened(corners: Float[np.ndarray, "K 3"]) -> Float[np.ndarray, "K 2"]:
    """Corners in the plane of their polygon, so turned that they go round counter-clockwise."""
    area = np.cross(corners, np.roll(corners, -1, axis=0)).sum(axis=0)
    axis = int(np.argmax(np.abs(area)))
    flat = np.delete(corners, axis, axis=1)
    first, second = flat, np.roll(flat, -1, axis=0)
    signed = np.sum(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])
    return flat if signed >= 0 else flat * np.array([-1.0, 1.0])


def _turn(flat: np.ndarray, left: list[int], k: int) -> float:
    """Twice the signed area of the triangle at a corner: above zero where the polygon is convex there."""
    a, b, c = flat[left[k - 1]], flat[left[k]], flat[left[(k + 1) % len(left)]]
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))


def _is_ear(flat: np.ndarray, left: list[int], k: int) -> bool:
    if _turn(flat, left, k) <= 0:
        return False
    corners = [left[k - 1], left[k], left[(k + 1) % len(left)]]
    a, b, c = flat[corners]
    others = flat[[index for index in left if index not in corners]]
    # A corner of the same place as one of the ear's, as along a seam, is not in it.
    apart = np.all([np.abs(others - corner).max(axis=1, initial=0) > 0 for corner in (a, b, c)], axis=0)
    sides = [
        (q[0] - p[0]) * (others[:, 1] - p[1]) - (q[1] - p[1]) * (others[:, 0] - p[0])
        for p, q in ((a, b), (b, c), (c, a))
    ]
    return not bool(np.any(apart & np.all(np.stack(sides) >= 0, axis=0)))
