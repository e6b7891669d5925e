"""The order in which few places are visited."""

import itertools

import numpy as np
from jaxtyping import Float, Int

# Up to so many places every order is tried: 5,040 tours, which take a millisecond.
_EXACT = 7


def shortest_order(
    between: Float[np.ndarray, "n n"], first: Float[np.ndarray, " n"], last: Float[np.ndarray, " n"]
) -> Int[np.ndarray, " n"]:
    """The order of an open tour through all places that costs least.

    between: cost from row to column; first: of beginning at a place; last: of ending there. Exact for up to 7
    places, beyond by nearest neighbours and 2-opt.
    """
    n = len(first)
    if n == 0:
        return np.zeros(0, int)
    if n <= _EXACT:
        tours = np.array(list(itertools.permutations(range(n))))
        return tours[_cost(tours, between, first, last).argmin()]
    return _improved(_nearest_first(between, first), between, first, last)


def _cost(tours: Int[np.ndarray, "tours n"], between, first, last) -> Float[np.ndarray, " tours"]:
    ends = first[tours[:, 0]] + last[tours[:, -1]]
    return ends + between[tours[:, :-1], tours[:, 1:]].sum(1)


def _nearest_first(between, first) -> Int[np.ndarray, " n"]:
    tour, left = [int(first.argmin())], set(range(len(first)))
    left.remove(tour[0])
    while left:
        tour.append(min(left, key=lambda i: (between[tour[-1], i], i)))
        left.remove(tour[-1])
    return np.array(tour)


def _improved(tour, between, first, last) -> Int[np.ndarray, " n"]:
    """Turns parts of the tour around as long as that makes it cheaper."""
    pairs = list(itertools.combinations(range(len(tour) + 1), 2))
    while True:
        others = np.array([[*tour[:i], *tour[i:j][::-1], *tour[j:]] for i, j in pairs])
        costs = _cost(others, between, first, last)
        if costs.min() >= _cost(tour[None], between, first, last)[0] - 1e-9:
            return tour
        tour = others[costs.argmin()]
