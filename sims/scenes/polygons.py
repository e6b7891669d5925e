"""Polygons of any shape, cut into triangles that do not overlap.

Fans, into which polygons are usually cut, fill what a polygon leaves open: a door becomes wall.
"""

import numpy as np
from jaxtyping import Float, Int


def cut(
    points: Float[np.ndarray, "V 3"], corners: Int[np.ndarray, "C"], counts: Int[np.ndarray, "P"]
) -> Int[np.ndarray, "F 3"]:
    """Triangles of all polygons, in their order: as many as each has corners, less two.

    corners: indices of the polygons' corners, one polygon after another. counts: of corners of each.
    """
    first = np.cumsum(counts) - counts
    three, four = first[counts == 3], first[counts == 4]
    quads = corners[four[:, None] + np.arange(4)]
    halves, simple = _halved(points, quads)
    found = [corners[three[:, None] + np.arange(3)], halves.reshape(-1, 3)]
    places = [three, np.repeat(four[simple], 2)]
    rest = np.concatenate([four[~simple], first[counts > 4]])
    sizes = np.concatenate([np.full((~simple).sum(), 4), counts[counts > 4]])
    for start, size in zip(rest.tolist(), sizes.tolist(), strict=True):
        triangles = triangulate(points, corners[start : start + size].tolist())
        found.append(np.array(triangles))
        places.append(np.full(len(triangles), start))
    order = np.argsort(np.concatenate(places), kind="stable")
    return np.concatenate(found)[order].astype(np.int64)


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


def _halved(
    points: Float[np.ndarray, "V 3"], quads: Int[np.ndarray, "Q 4"]
) -> tuple[Int[np.ndarray, "S 2 3"], np.ndarray]:
    """Two triangles of each quad that turns left at three corners or all, and which quads these are [Q].

    The diagonal begins at the corner that turns right, else at the second: what cutting ears does.
    """
    ahead = points[np.roll(quads, -1, axis=1)] - points[quads]
    turns = np.cross(np.roll(ahead, 1, axis=1), ahead)
    area = np.cross(points[quads[:, 2]] - points[quads[:, 0]], points[quads[:, 3]] - points[quads[:, 1]])
    axis = np.argmax(np.abs(area), axis=1)
    each = np.arange(len(quads))
    turn = turns[each, :, axis] * np.sign(area[each, axis])[:, None]
    simple = (turn != 0).all(axis=1) & ((turn > 0).sum(axis=1) >= 3)
    start = np.where((turn < 0).any(axis=1), np.argmin(turn, axis=1), 1)[simple, None]
    round_ = np.take_along_axis(quads[simple], (start + np.arange(4)) % 4, axis=1)
    return np.stack([round_[:, [0, 1, 2]], round_[:, [2, 3, 0]]], axis=1), simple


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
