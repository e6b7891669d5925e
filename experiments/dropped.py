"""What of a picture was left out, in words: how many points, of which strokes, and why."""

from collections.abc import Iterable

import numpy as np
from jaxtyping import Int

from jaxpaint.mapping.mapped import Cause

REASONS = {
    Cause.MISS: "over a hole or the wall's rim",
    Cause.FRONT: "no consistent surface",
    Cause.STEEP: "too steep",
    Cause.SHARP: "on an edge",
    Cause.CLEARANCE: "too near to another surface for the brush",
    Cause.SHORT: "in pieces too short to paint",
    Cause.OVERFLOW: "in more pieces than a path has room for",
}
"""What a person is told for each cause."""

# Numbers of strokes that a line names before it only counts the rest.
_NAMED = 12


def cause_counts(status: Int[np.ndarray, "worlds points"]) -> Int[np.ndarray, "causes points"]:
    """In how many worlds each point met each `Cause`."""
    return np.stack([(status == cause).sum(axis=0) for cause in Cause])


def dropped_words(stroke: Int[np.ndarray, " points"], counts: Int[np.ndarray, "causes points"]) -> list[str]:
    """One line for each reason why points were left out, with the strokes they belong to.

    stroke: the stroke of each point, from 0; names count from 1, as the preview does. counts: by
    `cause_counts`. A point counts where it was left out in at least half of the worlds, by its commonest
    cause.
    """
    lost = 2 * counts[Cause.HIT] <= counts.sum(axis=0)
    cause = 1 + counts[1:].argmax(axis=0)
    lines = []
    for reason, words in REASONS.items():
        here = lost & (cause == reason)
        if here.any():
            names = stroke_names(1 + np.unique(stroke[here]))
            lines.append(f"left out, {words}: {here.sum()} of {len(stroke)} points, in {names}")
    return lines


def stroke_names(numbers: Iterable[int]) -> str:
    """Stroke numbers as ranges: `stroke 3`, or `strokes 3, 7-12 and 5 more`."""
    found = [int(n) for n in numbers]
    ranges: list[list[int]] = []
    for n in found:
        if ranges and n == ranges[-1][1] + 1:
            ranges[-1][1] = n
        else:
            ranges.append([n, n])
    shown = ", ".join(str(a) if a == b else f"{a}-{b}" for a, b in ranges[:_NAMED])
    rest = sum(b - a + 1 for a, b in ranges[_NAMED:])
    return f"stroke{'s' * (len(found) > 1)} {shown}" + (f" and {rest} more" if rest else "")
