"""Local search that shortens the travel between lines: 2-opt turns runs of lines, Or-opt moves short runs.

A tour is the array of the lines' ends (start, stop), as complex numbers u + iv because their differences and
lengths are quick, in the order in which they are painted. Its travel is from each stop to the next start; its
first line stays first and keeps its direction.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Complex, Float, Int

from jaxpaint.pictures.drawing import Polyline

Ends = Complex[np.ndarray, "lines 2"]

_SWEEPS = 30  # of 2-opt; it settles in about ten
_RUN = 1000  # lines in a run that 2-opt turns at most, so that its time grows with the lines alone
_MOVED = 3  # lines in a run that Or-opt moves at most
_GAIN = 1e-12  # of the size of the tour: less is rounding, and could go on for ever


@dataclass(frozen=True, eq=False)
class Tour:
    """ends: as they are painted. order: where each stood first. turned: whether each is backwards."""

    ends: Ends
    order: Int[np.ndarray, " lines"]
    turned: Bool[np.ndarray, " lines"]

    def rearranged(self, index: Int[np.ndarray, " lines"], run: slice, turn: bool) -> "Tour":
        """The tour with its lines taken by index, those that are then in the run turned round if asked."""
        ends, turned = self.ends[index], self.turned[index]
        if turn:
            ends[run], turned[run] = ends[run, ::-1].copy(), ~turned[run]
        return Tour(ends, self.order[index], turned)


def tour_of(lines: list[Polyline]) -> Tour:
    """The tour of lines in their present order."""
    ends = np.array([(line[0], line[-1]) for line in lines]) @ [1, 1j]
    return Tour(ends, np.arange(len(ends)), np.zeros(len(ends), dtype=bool))


def two_opt(tour: Tour) -> Tour:
    """Turns runs round until no turn saves travel, or 30 times through the tour."""
    for _ in range(_SWEEPS):
        before = tour
        tour = _sweep(tour, _turn_run)
        if tour is before:
            break
    return tour


def or_opt(tour: Tour) -> Tour:
    """Once through the tour, moves runs of up to three lines to where they cost less, either way round."""
    for lines in range(1, _MOVED + 1):
        tour = _sweep(tour, lambda tour, i, least, lines=lines: _move_run(tour, i, lines, least))
    return tour


def _sweep(tour: Tour, improve: Callable[[Tour, int, float], Tour]) -> Tour:
    """One try to improve at each line but the first; the same tour where none helped."""
    least = _GAIN * float(np.abs(tour.ends - tour.ends[0, 0]).max())
    for i in range(1, len(tour.ends)):
        tour = improve(tour, i, least)
    return tour


def _turn_run(tour: Tour, i: int, least: float) -> Tour:
    """The run from line i turned round whose turn saves most, if any saves."""
    ends = tour.ends
    before, first = ends[i - 1, 1], ends[i, 0]
    last, after = ends[i : i + _RUN, 1], ends[i + 1 : i + 1 + _RUN, 0]
    saved = np.abs(before - first) - np.abs(before - last)
    followed = len(after)  # one less than the runs where the last run ends the tour
    saved[:followed] += np.abs(last[:followed] - after) - np.abs(first - after)
    best = int(saved.argmax())
    if saved[best] <= least:
        return tour
    index = np.arange(len(ends))
    run = slice(i, i + best + 1)
    index[run] = index[run][::-1].copy()
    return tour.rearranged(index, run, turn=True)


def _move_run(tour: Tour, i: int, lines: int, least: float) -> Tour:
    """The run of so many lines from line i where it adds least, if that is less than where it is."""
    run, rest = tour.ends[i : i + lines], np.delete(tour.ends, slice(i, i + lines), axis=0)
    if len(run) < lines:
        return tour
    first, last = run[0, 0], run[-1, 1]
    added = np.stack([_added(rest, first, last), _added(rest, last, first)])
    turn, k = divmod(int(added.argmin()), len(rest))
    if added[0, i - 1] - added[turn, k] <= least:
        return tour
    index = np.arange(len(tour.ends))
    moved = index[i : i + lines]
    index = np.insert(np.delete(index, moved), k + 1, moved[::-1] if turn else moved)
    return tour.rearranged(index, slice(k + 1, k + 1 + lines), turn=bool(turn))


def _added(rest: Ends, first: complex, last: complex) -> Float[np.ndarray, " lines"]:
    """The travel that a run adds behind each line of a tour, from its first point to its last."""
    stops, starts = rest[:, 1], rest[1:, 0]
    added = np.abs(stops - first)
    added[:-1] += np.abs(last - starts) - np.abs(stops[:-1] - starts)
    return added
