"""Centre-lines of ink given as pixels: the branches of its skeleton, joined as a pen would draw them."""

from dataclasses import dataclass, replace

import cv2
import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import gaussian_filter1d, map_coordinates

from jaxpaint.pictures.drawing import Polyline, is_closed, polyline_length
from jaxpaint.pictures.skeleton_graph import Branch, graph_of

_STRAIGHT = np.radians(60)  # two branches that turn less than this at a junction are one line
_SMOOTH = 1.5  # standard deviation of the filter along a line, in pixels
_SPUR = 1.2  # branches shorter than this many half widths of the ink where they leave it are its roughness
_BRIDGE = 2.0  # junctions nearer than this many half widths are one crossing


@dataclass(frozen=True, eq=False)
class CentreLine:
    """points: (x, y) in pixels, x of column 0's middle is 0. free: whether its start and its end are tips of
    the ink. Otherwise they lie on a junction.
    """

    points: Polyline
    free: tuple[bool, bool]


def centre_lines(ink: Bool[np.ndarray, "rows columns"], *, line_art: bool = True) -> list[CentreLine]:
    """The centre-lines of ink: spurs removed, straight on at junctions, smooth to a fraction of a pixel.

    line_art: the ink is lines, so junctions nearer than their width are one crossing.
    """
    half = half_width(ink)
    branches = _pruned(graph_of(ink), half)
    branches = _contracted(branches, half) if line_art else branches
    return [_smooth(line) for line in _joined(branches, half)]


def half_width(ink: Bool[np.ndarray, "rows columns"]) -> Float[np.ndarray, "rows columns"]:
    """Distance from the middle of each pixel of the ink to its rim, in pixels."""
    padded = cv2.copyMakeBorder(ink.astype(np.uint8), 1, 1, 1, 1, cv2.BORDER_CONSTANT, value=0)
    distance = cv2.distanceTransform(padded, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)[1:-1, 1:-1]
    return np.maximum(distance - 0.5, 0)


def sampled(field: Float[np.ndarray, "rows columns"], points: Polyline) -> Float[np.ndarray, " points"]:
    """Values of a field of pixels between them."""
    return map_coordinates(field, points.T[::-1], order=1, mode="nearest")


def _degrees(branches: list[Branch]) -> dict[int, int]:
    degrees: dict[int, int] = {}
    for branch in branches:
        for node in branch.nodes:
            degrees[node] = degrees.get(node, 0) + 1
    return degrees


def _pruned(branches: list[Branch], half: np.ndarray) -> list[Branch]:
    """Without the short branches that end near the rim, shortest first, while their node has others."""
    kept = sorted(branches, key=lambda branch: polyline_length(branch.points))
    degrees = _degrees(kept)
    result = []
    for branch in kept:
        tips = [degrees[node] == 1 for node in branch.nodes]
        if sum(tips) == 1:
            root = branch.points[0] if tips[1] else branch.points[-1]
            limit = _SPUR * float(sampled(half, root[None])[0]) + 1.0
            if degrees[branch.nodes[0 if tips[1] else 1]] > 2 and polyline_length(branch.points) < limit:
                for node in branch.nodes:
                    degrees[node] -= 1
                continue
        result.append(branch)
    return result


def _contracted(branches: list[Branch], half: np.ndarray) -> list[Branch]:
    """With junctions that are one crossing, drawn apart by the skeleton, as one."""
    degrees = _degrees(branches)
    pairs = [frozenset(branch.nodes) for branch in branches]
    parent: dict[int, int] = {}

    def root(node: int) -> int:
        while node in parent:
            node = parent[node]
        return node

    place: dict[int, list[np.ndarray]] = {}
    kept = []
    for branch, pair in zip(branches, pairs, strict=True):
        a, b = branch.nodes
        width = float(sampled(half, branch.points[[0, -1]]).max())
        bridge = a != b and min(degrees[a], degrees[b]) > 2 and pairs.count(pair) == 1
        if bridge and polyline_length(branch.points) < _BRIDGE * width and root(a) != root(b):
            place.setdefault(root(b), []).extend(
                [*place.pop(root(a), []), branch.points[0], branch.points[-1]]
            )
            parent[root(a)] = root(b)
        else:
            kept.append(branch)
    return [_moved(branch, root, place) for branch in kept]


def _moved(branch: Branch, root, place: dict[int, list[np.ndarray]]) -> Branch:
    """A branch whose ends lie on the crossings that their junctions became."""
    nodes = (root(branch.nodes[0]), root(branch.nodes[1]))
    points = branch.points.copy()
    for node, end in zip(nodes, (0, -1), strict=True):
        if node in place:
            points[end] = np.mean(place[node], axis=0)
    return replace(branch, nodes=nodes, points=points)


def _joined(branches: list[Branch], half: np.ndarray) -> list[CentreLine]:
    """Lines through the junctions: at each, the branches that go on most straightly belong together."""
    ends: dict[int, list[tuple[int, int]]] = {}
    for i, branch in enumerate(branches):
        for end in (0, 1):
            ends.setdefault(branch.nodes[end], []).append((i, end))
    partner: dict[tuple[int, int], tuple[int, int]] = {}
    for met in ends.values():
        for a, b in _pairs(branches, met, half):
            partner[a], partner[b] = b, a
    tips = {met[0] for met in ends.values() if len(met) == 1}
    starts = [(i, end) for i in range(len(branches)) for end in (0, 1) if (i, end) not in partner]
    rings = [(i, 0) for i in range(len(branches))]
    used: set[int] = set()
    lines = []
    for start in starts + rings:
        if start[0] not in used:
            points, last = _followed(branches, partner, start, used)
            lines.append(CentreLine(points, (start in tips, last in tips)))
    return lines


def _followed(branches, partner, start, used) -> tuple[Polyline, tuple[int, int]]:
    """The points of a line from one of its ends, and its other end."""
    pieces, here = [], start
    while True:
        i, end = here
        used.add(i)
        points = branches[i].points if end == 0 else branches[i].points[::-1]
        pieces.append(points if not pieces else points[1:])
        last = (i, 1 - end)
        after = partner.get(last)
        if after is None or after[0] in used:
            break
        here = after
    line = np.concatenate(pieces)
    if partner.get(last) == start and len(line) > 3:
        line = np.concatenate([line[:-1], line[:1]])
    return line, last


def _pairs(branches, met, half):
    """The ends at one junction that continue each other, straightest first."""
    if len(met) < 2:
        return []
    heading = {end: _heading(branches[end[0]], end[1], half) for end in met}
    turns = [
        (float(np.arccos(np.clip(-heading[a] @ heading[b], -1, 1))), a, b)
        for k, a in enumerate(met)
        for b in met[k + 1 :]
    ]
    pairs, taken = [], set()
    for turn, a, b in sorted(turns, key=lambda item: item[0]):
        if not {a, b} & taken and (turn < _STRAIGHT or len(met) == 2):
            pairs.append((a, b))
            taken |= {a, b}
    return pairs


def _heading(branch: Branch, end: int, half: np.ndarray) -> np.ndarray:
    """Unit vector in which a branch leaves a junction, seen from beyond the blot of the junction itself."""
    points = branch.points if end == 0 else branch.points[::-1]
    away = np.linalg.norm(points - points[0], axis=1)
    near = 1.2 * float(sampled(half, points[:1])[0]) + 1.0
    first = min(int(np.argmax(away >= near)) if (away >= near).any() else len(points) - 1, len(points) - 1)
    far = away >= near + 4.0
    last = int(np.argmax(far)) if far.any() else len(points) - 1
    step = points[last] - (points[first] if last > first else points[0])
    return step / max(float(np.linalg.norm(step)), 1e-12)


def _smooth(line: CentreLine) -> CentreLine:
    """Without the stairs of the pixels; the ends stay where they are."""
    points = line.points
    if len(points) < 4:
        return line
    if is_closed(points):
        ring = gaussian_filter1d(points[:-1], _SMOOTH, axis=0, mode="wrap")
        return replace(line, points=np.concatenate([ring, ring[:1]]))
    # Mirrored through the end points, so that these stay and the line keeps its direction there.
    n = len(points) - 1
    padded = np.concatenate([2 * points[0] - points[n:0:-1], points, 2 * points[-1] - points[n - 1 :: -1]])
    return replace(line, points=gaussian_filter1d(padded, _SMOOTH, axis=0)[n : 2 * n + 1])
