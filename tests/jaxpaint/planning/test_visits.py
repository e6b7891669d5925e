"""Tours: the cheapest of all where there are few places, and none to be improved by turning a part around."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jaxpaint.planning.visits import shortest_order


def tour_cost(order, between, first, last):
    legs = sum(between[a, b] for a, b in itertools.pairwise(order))
    return first[order[0]] + legs + last[order[-1]]


def places(seed, count):
    rng = np.random.default_rng(seed)
    points = rng.uniform(size=(count, 2))
    between = np.linalg.norm(points[:, None] - points, axis=-1)
    return between, np.linalg.norm(points, axis=1), np.linalg.norm(points - 1, axis=1)


@given(seed=st.integers(0, 100), count=st.integers(1, 6))
def test_few_places_are_visited_in_the_best_order(seed, count):
    costs = places(seed, count)
    best = min(tour_cost(order, *costs) for order in itertools.permutations(range(count)))
    assert tour_cost(shortest_order(*costs), *costs) == pytest.approx(best)


def test_many_places_on_a_line_are_visited_along_it():
    way = np.random.default_rng(0).permutation(12).astype(float)
    order = shortest_order(np.abs(way[:, None] - way), np.zeros(12), way)
    np.testing.assert_array_equal(way[order], np.arange(12)[::-1])


@given(seed=st.integers(0, 100))
def test_many_places_are_all_visited_once(seed):
    order = shortest_order(*places(seed, 9))
    assert sorted(order) == list(range(9))


def test_nowhere_to_go():
    assert shortest_order(np.zeros((0, 0)), np.zeros(0), np.zeros(0)).size == 0
