"""Contours of films whose edges are known."""

import numpy as np
import pytest

from sims.scoring.contours import contour


def cone(radius, shape=(80, 90), middle=(44.3, 40.7)):
    """A film that falls by 1 a cell and is `radius` in the middle."""
    row, column = np.indices(shape)
    return radius - np.hypot(column - middle[0], row - middle[1])


def test_a_circle_is_found_to_a_small_part_of_a_cell():
    found = contour(cone(30.0), 10.0)
    away = np.hypot(*(found.middle - [44.3, 40.7]).T)
    np.testing.assert_allclose(away, 20, atol=0.03)
    assert found.length.sum() == pytest.approx(2 * np.pi * 20, rel=2e-3)


def test_even_film_has_none_and_the_border_is_none():
    assert len(contour(np.ones((5, 6)), 0.5).middle) == 0
    assert len(contour(np.zeros((5, 6)), 0.5).middle) == 0


def test_straight_edge_of_a_step():
    film = np.zeros((10, 12))
    film[:, 5:] = 1.0
    found = contour(film, 0.2)
    np.testing.assert_allclose(found.middle[:, 0], 4.2)
    assert found.length.sum() == pytest.approx(9)


@pytest.mark.parametrize(("level", "cut_off"), [(0.4, False), (0.6, True)])
def test_a_saddle_joins_what_its_mean_joins(level, cut_off):
    """Two pieces; each cuts a corner off that lies across from its like."""
    found = contour(np.asarray([[1.0, 0.0], [0.0, 1.0]]), level)
    assert len(found.length) == 2
    high_corners = np.asarray([[0.0, 0.0], [1.0, 1.0]])
    nearest = np.linalg.norm(found.middle[:, None] - high_corners, axis=-1).min(axis=1)
    low_corners = np.asarray([[1.0, 0.0], [0.0, 1.0]])
    other = np.linalg.norm(found.middle[:, None] - low_corners, axis=-1).min(axis=1)
    assert ((nearest < other) == cut_off).all()
