"""Lines whose ends meet become one, so that the brush stays down."""

from collections import defaultdict
from itertools import product

import numpy as np

from jaxpaint.pictures.drawing import Polyline, is_closed

_MEETING = 1e-6  # of the drawing's size

End = tuple[int, int]  # index of a line, and 0 for its first point or -1 for its last


def join_lines(lines: list[Polyline]) -> list[Polyline]:
    """Whole lines out of pieces: joined where exactly two ends meet, within 1e-6 of the drawing's size.

    Where three or more ends meet nobody can say which two belong together, so all stay apart. Chains stand at
    the place of their first piece and run in its direction where it begins the chain.
    """
    size = float(np.ptp(np.concatenate(lines), axis=0).max())
    partner = _partners(lines, _MEETING * size)
    joined, used = [], set()
    # Chains with a loose end first; what is left then are rings, which may start anywhere.
    starts = [(i, end) for end in (0, -1) for i in range(len(lines)) if (i, end) not in partner]
    rings = [(i, 0) for i in range(len(lines))]
    for start in starts + rings:
        if start[0] not in used:
            chain = _follow(start, partner)
            used.update(i for i, _ in chain)
            joined.append((min(i for i, _ in chain), _concatenate(lines, chain, ring=start in partner)))
    return [line for _, line in sorted(joined, key=lambda pair: pair[0])]


def _partners(lines: list[Polyline], tolerance: float) -> dict[End, End]:
    """For each end of an open line that meets exactly one other, that other."""
    ends = {(i, end): line[end] for i, line in enumerate(lines) if not is_closed(line) for end in (0, -1)}
    cells: dict[tuple[int, int], list[End]] = defaultdict(list)
    for end, point in ends.items():
        cells[_cell(point, tolerance)].append(end)
    met = {end: _near(end, point, ends, cells, tolerance) for end, point in ends.items()}
    return {end: others[0] for end, others in met.items() if len(others) == 1 and met[others[0]] == [end]}


def _near(end: End, point, ends, cells, tolerance: float) -> list[End]:
    """The other ends within the tolerance of a point."""
    u, v = _cell(point, tolerance)
    around = [other for du, dv in product((-1, 0, 1), repeat=2) for other in cells.get((u + du, v + dv), ())]
    return [other for other in around if other != end and np.linalg.norm(ends[other] - point) <= tolerance]


def _cell(point: np.ndarray, tolerance: float) -> tuple[int, int]:
    u, v = np.floor(point / tolerance).astype(np.int64)
    return int(u), int(v)


def _follow(start: End, partner: dict[End, End]) -> list[End]:
    """The lines of a chain, each by the end at which it is entered."""
    chain = [start]
    while True:
        line, entered = chain[-1]
        after = partner.get((line, -1 - entered))
        if after is None or after == start:
            return chain
        chain.append(after)


def _concatenate(lines: list[Polyline], chain: list[End], ring: bool) -> Polyline:
    """One line out of the pieces, the points where they meet once; a ring ends exactly where it starts."""
    pieces = [lines[i] if entered == 0 else lines[i][::-1] for i, entered in chain]
    line = np.concatenate([pieces[0], *(piece[1:] for piece in pieces[1:])])
    return np.concatenate([line[:-1], line[:1]]) if ring else line
