"""The fewest sets that cover all elements, and a bound below which no choice can go."""

import dataclasses
import math

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import csr_array

# Branching stops here, by count and not by the clock: the same answer on a slow machine.
_NODES = 500
# A linear programme's bound of 2.0000001 means 2.
_SLACK = 1e-6


@dataclasses.dataclass(frozen=True)
class Cover:
    """chosen: indices of the sets taken. bound: no cover has fewer sets. covered: share of the elements that
    any set has; the rest no choice covers, and none has to.
    """

    chosen: Int[np.ndarray, " chosen"]
    bound: int
    covered: float


def set_cover(has: Bool[np.ndarray, "sets elements"]) -> Cover:
    """The fewest sets that have every element which any set has, by branch and bound."""
    possible = has.any(0)
    share = float(possible.mean()) if possible.size else 0.0
    rows, sets = _reduced(has, np.zeros(len(has)))
    if not rows.size:
        return Cover(np.zeros(0, int), 0, share)
    greedy = _greedy(rows)
    bound = linear_bound(has)
    if len(greedy) == bound:
        return Cover(sets[greedy], bound, share)
    found = _solve(np.ones(len(sets)), rows)
    chosen = greedy if found.x is None or found.x.round().sum() > len(greedy) else _taken(found.x)
    return Cover(sets[chosen], max(bound, _whole(found.mip_dual_bound)), share)


def linear_bound(has: Bool[np.ndarray, "sets elements"]) -> int:
    """No cover of what can be covered has fewer sets: the linear programme that may take parts of sets."""
    rows, sets = _reduced(has, np.zeros(len(has)))
    if not rows.size:
        return 0
    found = _solve(np.ones(len(sets)), rows, whole=False)
    return _whole(found.fun) if found.fun is not None else 1


def cheap_cover(
    has: Bool[np.ndarray, "sets elements"], cost: Float[np.ndarray, " sets"], count: int
) -> Int[np.ndarray, " chosen"] | None:
    """A cheap cover of all elements by at most `count` sets; None where none was found."""
    if not has.any(0).all():
        return None
    rows, sets = _reduced(has, cost)
    found = _solve(cost[sets] + 1e-6, rows, most=count)
    return None if found.x is None else sets[_taken(found.x)]


def _reduced(has, cost) -> tuple[Bool[np.ndarray, "rows columns"], Int[np.ndarray, " columns"]]:
    """What decides: elements by sets, without sets that another one contains at no higher cost, and without
    elements that are covered with another one anyway. And which sets these are.
    """
    rows = np.unique(has[:, has.any(0)], axis=1)
    sets = np.flatnonzero(rows.any(1))
    sets = sets[~_within_another(rows[sets], cost[sets])]
    rows = np.unique(rows[sets], axis=1).T
    # Where all sets of one element have another element too, covering the first covers the other.
    easy = _within_another(~rows, np.zeros(len(rows)))
    return rows[~easy], sets


def _within_another(rows: Bool[np.ndarray, "n m"], cost: Float[np.ndarray, " n"]) -> Bool[np.ndarray, " n"]:
    """Rows that are part of another one of no higher cost; of equal ones the first stays."""
    whole = rows.astype(np.float32)
    size = whole.sum(1)
    part = (whole @ whole.T >= size[:, None]) & (cost[None, :] <= cost[:, None])
    same = part & part.T & (size[:, None] == size[None, :])
    first = np.arange(len(rows))
    return (part & ~(same & (first[None, :] >= first[:, None]))).any(1)


def _solve(cost, rows, *, whole: bool = True, most: int | None = None):
    """The cheapest choice of columns that has every row, of at most so many."""
    limits = [LinearConstraint(csr_array(rows.astype(float)), 1, np.inf)]
    if most is not None:
        limits.append(LinearConstraint(np.ones((1, len(cost))), 0, most))
    return milp(
        cost,
        integrality=np.full(len(cost), int(whole)),
        bounds=Bounds(0, 1),
        constraints=limits,
        options={"node_limit": _NODES},
    )


def _taken(x: Float[np.ndarray, " sets"]) -> Int[np.ndarray, " chosen"]:
    return np.flatnonzero(x > 0.5)


def _whole(bound: float | None) -> int:
    return 0 if bound is None or not math.isfinite(bound) else math.ceil(bound - _SLACK)


def _greedy(rows: Bool[np.ndarray, "elements sets"]) -> Int[np.ndarray, " chosen"]:
    """The set that has most of what is missing, until nothing is."""
    missing, chosen = np.ones(len(rows), bool), []
    while missing.any():
        chosen.append(int(rows[missing].sum(0).argmax()))
        missing &= ~rows[:, chosen[-1]]
    return np.array(chosen)
