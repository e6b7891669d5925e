"""In which order and from which end lines are painted, so that the brush travels little with the pen up.

A route is an order of lines with, for each, the index of the point where it is entered: the first or the last
of an open line, any of a closed one, which is left where it was entered.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Float, Int

from jaxpaint.pictures.drawing import Polyline, is_closed
from jaxpaint.pictures.shortening import or_opt, tour_of, two_opt

_CANDIDATES = 16  # points of a closed line that the greedy search looks at


@dataclass(frozen=True, eq=False)
class Route:
    """order: the lines, as they are painted. entry: the point at which each of them is entered."""

    order: Int[np.ndarray, " lines"]
    entry: Int[np.ndarray, " lines"]


def painted(lines: list[Polyline], route: Route) -> list[Polyline]:
    """The lines in the order and direction of a route."""
    return [_entered(lines[i], int(entry)) for i, entry in zip(route.order, route.entry, strict=True)]


def travel(lines: list[Polyline]) -> float:
    """How far it is from the end of each line to the start of the next."""
    return float(sum(np.linalg.norm(after[0] - before[-1]) for before, after in pairwise(lines)))


def file_route(lines: list[Polyline]) -> Route:
    """Every line as and where the file has it."""
    return Route(np.arange(len(lines)), np.zeros(len(lines), dtype=int))


def greedy_route(lines: list[Polyline], start: Float[np.ndarray, "2"]) -> Route:
    """From a start point always to the nearest point at which a line not yet painted can be entered."""
    entries = [_entries(line) for line in lines]
    first = np.cumsum([0, *(len(entry) for entry in entries)])
    owner = np.repeat(np.arange(len(lines)), np.diff(first))
    points = np.concatenate([line[entry] for line, entry in zip(lines, entries, strict=True)])
    u, v = points.T.copy()
    here, order, entry = np.asarray(start, dtype=float), [], []
    for _ in lines:
        nearest = int((np.square(u - here[0]) + np.square(v - here[1])).argmin())
        line = int(owner[nearest])
        order.append(line)
        entry.append(int(entries[line][nearest - first[line]]))
        here = _entered(lines[line], entry[-1])[-1]
        u[first[line] : first[line + 1]] = np.inf  # painted: never the nearest again
    return Route(np.array(order), np.array(entry))


def shortened(lines: list[Polyline], route: Route) -> Route:
    """A route of no more travel, the first line kept: order and entries of closed lines improved by turns."""
    best = travel(painted(lines, route))
    while True:
        route = _moved_entries(lines, _reordered(lines, route))
        now = travel(painted(lines, route))
        if now >= 0.99 * best:
            return route
        best = now


def _entries(line: Polyline) -> Int[np.ndarray, " entries"]:
    """Points of a line at which the greedy search may enter it."""
    last = len(line) - 1
    if not is_closed(line):
        return np.array([0, last])
    return np.unique(np.linspace(0, last - 1, min(last, _CANDIDATES)).round().astype(int))


def _entered(line: Polyline, entry: int) -> Polyline:
    """A line from the point where it is entered to the point where it is left."""
    if not is_closed(line):
        return line if entry == 0 else line[::-1]
    ring = np.roll(line[:-1], -entry, axis=0)
    return np.concatenate([ring, ring[:1]])


def _reordered(lines: list[Polyline], route: Route) -> Route:
    """Local search over order and direction. A closed line, left where it was entered, is never turned."""
    tour = two_opt(or_opt(two_opt(tour_of(painted(lines, route)))))
    order, entry = route.order[tour.order], route.entry[tour.order]
    last = np.array([len(lines[i]) - 1 for i in order])
    closed = np.array([is_closed(lines[i]) for i in order])
    return Route(order, np.where(tour.turned & ~closed, last - entry, entry))


def _moved_entries(lines: list[Polyline], route: Route) -> Route:
    """Each closed line but the first entered at its point nearest to the lines before and after it."""
    ends = painted(lines, route)
    entry = route.entry.copy()
    for k in range(1, len(ends)):
        line = lines[route.order[k]]
        if not is_closed(line):
            continue
        detour = np.linalg.norm(line[:-1] - ends[k - 1][-1], axis=1)
        if k + 1 < len(ends):
            detour += np.linalg.norm(line[:-1] - ends[k + 1][0], axis=1)
        entry[k] = detour.argmin()
        ends[k] = _entered(line, int(entry[k]))
    return Route(route.order, entry)
