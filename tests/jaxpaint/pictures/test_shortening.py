"""Local search: never longer, nothing lost, and the known optimum of small cases."""

from itertools import permutations, product

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from jaxpaint.pictures.shortening import Tour, or_opt, tour_of, two_opt

seeds = st.integers(0, 10_000)


def some_lines(seed: int, count: int) -> list[np.ndarray]:
    return list(np.random.default_rng(seed).uniform(0, 1, (count, 2, 2)))


def travelled(tour: Tour) -> float:
    return float(np.abs(tour.ends[1:, 0] - tour.ends[:-1, 1]).sum())


def check_book_keeping(tour: Tour, lines: list[np.ndarray]):
    """The tour's ends are those of the lines it names, each once, turned where it says; the first stays."""
    assert sorted(tour.order) == list(range(len(lines)))
    expected = [
        lines[i][::-1] if turned else lines[i] for i, turned in zip(tour.order, tour.turned, strict=True)
    ]
    np.testing.assert_array_equal(np.stack([tour.ends.real, tour.ends.imag], axis=-1), np.array(expected))
    assert tour.order[0] == 0 and not tour.turned[0]


@given(seeds, st.integers(1, 30))
def test_each_search_shortens_and_loses_nothing(seed, count):
    lines = some_lines(seed, count)
    tour = tour_of(lines)
    for search in (two_opt, or_opt):
        shorter = search(tour)
        check_book_keeping(shorter, lines)
        assert travelled(shorter) <= travelled(tour) + 1e-12
        tour = shorter


@given(seeds)
def test_no_turn_saves_after_two_opt(seed):
    lines = some_lines(seed, 9)
    best = two_opt(tour_of(lines))
    for i in range(1, 9):
        for j in range(i, 9):
            ends = best.ends.copy()
            ends[i : j + 1] = ends[i : j + 1][::-1, ::-1].copy()
            assert travelled(Tour(ends, best.order, best.turned)) >= travelled(best) - 1e-9


def test_lines_on_a_row_are_put_in_their_order():
    """Every search result of five lines is compared with the best of all orders and directions."""
    lines = [np.array([[x, 0.0], [x + 0.4, 0.0]]) for x in (0.0, 3.0, 1.0, 4.0, 2.0)]
    tour = or_opt(two_opt(tour_of(lines)))
    best = min(
        travelled(
            tour_of(
                [lines[0], *(lines[i][:: -1 if turn else 1] for i, turn in zip(rest, turns, strict=True))]
            )
        )
        for rest in permutations(range(1, 5))
        for turns in product([False, True], repeat=4)
    )
    assert np.isclose(travelled(tour), best)


def test_or_opt_moves_a_line_that_no_turn_can_place():
    """A line left for the end, to which the tour must come back, is painted on the way instead."""
    row = [np.array([[x, 0.0], [x + 0.9, 0.0]]) for x in range(6)]
    late = np.array([[2.9, 0.1], [3.0, 0.1]])
    tour = tour_of([*row, late])
    moved = or_opt(tour)
    assert moved.order.tolist() == [0, 1, 2, 6, 3, 4, 5]
    assert travelled(moved) < travelled(tour) / 3
