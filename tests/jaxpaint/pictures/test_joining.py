"""Pieces become whole lines where exactly two ends meet."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from jaxpaint.pictures.drawing import is_closed
from jaxpaint.pictures.joining import join_lines


def lines(*pieces):
    return [np.array(piece, dtype=float) for piece in pieces]


def as_lists(joined):
    return [line.tolist() for line in joined]


def test_two_ends_that_meet():
    joined = join_lines(lines([[0, 0], [1, 0]], [[1, 0], [1, 1]]))
    assert as_lists(joined) == [[[0, 0], [1, 0], [1, 1]]]


def test_a_piece_drawn_the_other_way_is_turned():
    joined = join_lines(lines([[0, 0], [1, 0]], [[1, 1], [1, 0]]))
    assert as_lists(joined) == [[[0, 0], [1, 0], [1, 1]]]


def test_three_ends_stay_apart():
    pieces = lines([[0, 0], [1, 0]], [[1, 0], [2, 0]], [[1, 0], [1, 1]])
    assert as_lists(join_lines(pieces)) == as_lists(pieces)


def test_an_end_on_the_middle_of_a_line_is_no_meeting():
    pieces = lines([[0, 0], [1, 0], [2, 0]], [[1, 0], [1, 1]])
    assert as_lists(join_lines(pieces)) == as_lists(pieces)


def test_ends_near_each_other_but_not_within_the_tolerance_stay_apart():
    near, far = (
        lines([[0, 0], [1, 0]], [[1 + 1e-7, 0], [2, 0]]),
        lines([[0, 0], [1, 0]], [[1 + 1e-4, 0], [2, 0]]),
    )
    assert len(join_lines(near)) == 1
    assert len(join_lines(far)) == 2


def test_a_ring_of_pieces_closes_exactly():
    joined = join_lines(lines([[0, 0], [1, 0]], [[1, 1], [1, 1e-9]], [[1, 1], [0, 1e-9]]))
    assert len(joined) == 1 and is_closed(joined[0]) and len(joined[0]) == 4


def test_closed_lines_are_left_alone():
    square = [[0, 0], [1, 0], [1, 1], [0, 0]]
    pieces = lines(square, [[0, 0], [-1, 0]])
    assert as_lists(join_lines(pieces)) == as_lists(pieces)


@given(st.permutations(range(7)), st.lists(st.booleans(), min_size=7, max_size=7))
def test_a_line_cut_to_pieces_in_any_order_is_whole_again(order, turned):
    whole = np.random.default_rng(0).normal(size=(8, 2))
    pieces = [whole[i : i + 2][:: -1 if turned[i] else 1] for i in order]
    (joined,) = join_lines(pieces)
    assert joined.tolist() in (whole.tolist(), whole[::-1].tolist())
