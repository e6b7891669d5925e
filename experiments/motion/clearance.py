"""How near a robot comes to anything on its way, with a bound between the moments that are looked at."""

from itertools import pairwise

import numpy as np
from jaxtyping import Bool, Float

from experiments.motion.truth import BRUSH, ITSELF, Posture, Truth

# So many rows lie between two moments at first; where that is too coarse the way between is halved, down to
# 2^-_DEEPEST of it.
_COARSE, _DEEPEST = 16, 12
# An arc is this much longer than its chord, at most.
_ARC = 1.02


def distances(
    truth: Truth, q: Float[np.ndarray, "times joints"], brush: Bool[np.ndarray, " times"]
) -> Float[np.ndarray, "3"]:
    """A lower bound of the least distance of each kind (see `truth`) [m], at and between rows.

    brush: where the brush's distance counts. Between two moments at which a point of the robot moves by d at
    most a distance is no less than the mean of its two values less d / 2, twice that where both sides move.
    Where both are above zero and that bound is less than half of them, the way is looked at more closely.
    """
    least = np.full(3, np.inf)
    moments = np.unique(np.append(np.arange(0, len(q), _COARSE), len(q) - 1))
    before = truth.posture(q[moments[0]])
    for first, last in pairwise(moments):
        if (q[first : last + 1] == q[first]).all():
            least = np.minimum(least, _counted(before.distance, bool(brush[first : last + 1].any())))
            continue
        after = truth.posture(q[last])
        least = np.minimum(least, _between(truth, q, brush, (float(first), before), (float(last), after)))
        before = after
    return least


def _between(
    truth: Truth, q, brush, one: tuple[float, Posture], other: tuple[float, Posture], depth: int = 0
):
    """The bound of each kind between two moments, given as rows with fractions."""
    (first, a), (last, b) = one, other
    counts = bool(brush[int(np.floor(first)) : int(np.ceil(last)) + 1].any())
    low = _counted(np.minimum(a.distance, b.distance), counts)
    twice = np.where(np.arange(3) == ITSELF, 2, 1)
    bound = _counted((a.distance + b.distance - _ARC * twice * truth.moved(a, b)) / 2, counts)
    if (low <= 0).any() or (bound >= low / 2).all() or depth == _DEEPEST:
        return np.minimum(bound, low)
    middle = (first + last) / 2
    row = int(np.floor(middle))
    there = truth.posture(q[row] + (middle - row) * (q[min(row + 1, len(q) - 1)] - q[row]))
    halves = ((one, (middle, there)), ((middle, there), other))
    return np.minimum(*(_between(truth, q, brush, *half, depth + 1) for half in halves))


def _counted(distance: Float[np.ndarray, "3"], brush: bool) -> Float[np.ndarray, "3"]:
    return np.where((np.arange(3) == BRUSH) & (not brush), np.inf, distance)
