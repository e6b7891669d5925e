"""Points in areas, against circles and squares."""

import numpy as np

from sims.scoring.even_odd import FilledAreas, even_odd


def circle(radius, middle=(0.0, 0.0), points=720):
    angle = np.linspace(0, 2 * np.pi, points)
    return np.asarray(middle) + radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def square(left, low, size):
    return np.asarray([left, low]) + size * np.asarray([[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]], float)


def anywhere(count=4000, reach=0.15, seed=0):
    return np.random.default_rng(seed).uniform(-reach, reach, (count, 2))


def test_a_ring_with_a_hole_in_it_and_an_island_in_that():
    points = anywhere()
    away = np.linalg.norm(points, axis=1)
    found = even_odd([circle(0.1), circle(0.06), circle(0.02)], points)
    sure = np.abs(away[:, None] - [0.1, 0.06, 0.02]).min(axis=1) > 1e-5
    np.testing.assert_array_equal(found[sure], (((away < 0.1) & (away > 0.06)) | (away < 0.02))[sure])


def test_a_ring_that_crosses_itself():
    bow = np.asarray([[0, 0], [0.1, 0.1], [0.1, 0], [0, 0.1], [0, 0]])
    np.testing.assert_array_equal(
        even_odd([bow], np.asarray([[0.09, 0.05], [0.01, 0.05], [0.05, 0.02], [0.05, 0.08]])),
        [True, True, False, False],
    )


def test_a_corner_at_a_points_height_counts_once():
    diamond = np.asarray([[0, -0.1], [0.1, 0], [0, 0.1], [-0.1, 0], [0, -0.1]])
    np.testing.assert_array_equal(even_odd([diamond], np.asarray([[0.0, 0.0], [-0.2, 0.0]])), [True, False])


def test_the_picture_and_the_rings_agree_everywhere():
    areas = [[circle(0.1), circle(0.05, (0.02, 0.0))], [square(-0.03, -0.03, 0.05)]]
    near = circle(0.1, points=3000) + np.random.default_rng(1).normal(scale=3e-4, size=(3000, 2))
    points = np.concatenate([anywhere(20000), near])
    by_rings = np.any([even_odd(rings, points) for rings in areas], axis=0)
    np.testing.assert_array_equal(FilledAreas(areas).contains(points), by_rings)


def test_far_away_and_nan_is_no_ink():
    fill = FilledAreas([[circle(0.1)]])
    assert not fill.contains(np.asarray([[5.0, 0.0], [np.nan, 0.0], [np.inf, 0.0]])).any()
    assert not FilledAreas([]).contains(np.zeros((2, 2))).any()


def test_ink_does_not_end_where_another_area_of_it_begins():
    touching = FilledAreas([[square(0.0, 0.0, 0.1)], [square(0.1, 0.0, 0.1)]])
    ends = np.concatenate([ring[there] for ring, there in touching.edges(0.001)])
    assert abs(len(ends) * 0.001 - 0.6) < 0.01
    between = (np.abs(ends[:, 0] - 0.1) < 1e-6) & (ends[:, 1] > 0.002) & (ends[:, 1] < 0.098)
    assert not between.any()
    alone = FilledAreas([[square(0.0, 0.0, 0.1)]])
    assert sum(there.sum() for _, there in alone.edges(0.001)) > 395
