"""Set covers against every choice tried."""

import itertools

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from jaxpaint.planning import set_cover
from jaxpaint.planning.set_cover import cheap_cover, linear_bound

SMALL = st.tuples(st.integers(1, 8), st.integers(1, 12)).flatmap(
    lambda shape: arrays(bool, shape, elements=st.booleans())
)


def covers(has):
    """All choices of sets that have everything, small ones first."""
    wanted = has.any(0)
    for size in range(len(has) + 1):
        for chosen in itertools.combinations(range(len(has)), size):
            if (has[list(chosen)].any(0) == wanted).all():
                yield chosen


@given(has=SMALL)
def test_no_choice_is_smaller(has):
    found = set_cover(has)
    fewest = len(next(covers(has)))
    assert len(found.chosen) == fewest
    assert found.bound <= fewest
    assert (has[found.chosen].any(0) == has.any(0)).all()
    assert found.covered == pytest.approx(has.any(0).mean())
    assert linear_bound(has) <= fewest


@given(has=SMALL, data=st.data())
def test_no_choice_of_that_number_is_cheaper(has, data):
    has = has[:, has.any(0)]
    assume(has.size)
    cost = np.array(data.draw(st.lists(st.integers(1, 9), min_size=len(has), max_size=len(has))), float)
    count = len(next(covers(has)))
    chosen = cheap_cover(has, cost, count)
    assert has[chosen].any(0).all()
    assert len(chosen) <= count
    assert cost[chosen].sum() == min(cost[list(c)].sum() for c in covers(has) if len(c) <= count)


def test_too_few_sets_are_said_to_be():
    assert cheap_cover(np.eye(3, dtype=bool), np.ones(3), 2) is None
    assert cheap_cover(np.array([[True, False]]), np.ones(1), 1) is None


def test_greed_is_not_enough():
    """Two halves cover what the largest set tempts to take first."""
    has = np.zeros((5, 14), bool)
    has[0, :7] = has[1, 7:] = True
    has[2, [0, 1, 2, 3, 7, 8, 9, 10]] = has[3, [4, 5, 11, 12]] = has[4, [6, 13]] = True
    found = set_cover(has)
    assert sorted(found.chosen) == [0, 1]
    assert found.bound == 2


def test_the_bound_counts_elements_that_no_set_shares():
    triangle = np.array([[1, 1, 0], [0, 1, 1], [1, 0, 1]], bool)
    assert linear_bound(triangle) == 2  # one and a half sets, in parts
    assert linear_bound(np.zeros((3, 0), bool)) == 0
