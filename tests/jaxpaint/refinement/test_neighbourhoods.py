"""Neighbourhoods: the right ones, in pieces or whole, near the origin or far from it."""

import numpy as np
import pytest

from jaxpaint.refinement import neighbourhoods
from jaxpaint.refinement.neighbourhoods import Neighbourhoods


def test_neighbours_are_the_nearest(flat):
    near = Neighbourhoods.of(flat, 12)
    distance = np.linalg.norm(flat[:, None] - flat[None], axis=-1)
    found = np.take_along_axis(distance, near.index, axis=1)
    np.testing.assert_allclose(found, np.sort(distance, axis=1)[:, :12])
    np.testing.assert_allclose(np.linalg.norm(near.around(slice(5, 9)), axis=0), found[5:9], atol=1e-12)
    np.testing.assert_array_equal(near.nearest(4).index, near.index[:, :4])


def test_pieces_make_the_whole(flat, monkeypatch):
    whole = Neighbourhoods.of(flat, 9)
    monkeypatch.setattr(neighbourhoods, "_QUERIES", 77)
    monkeypatch.setattr(neighbourhoods, "_ELEMENTS", 500)
    pieces = Neighbourhoods.of(flat, 9)
    np.testing.assert_array_equal(pieces.index, whole.index)
    sums = pieces.each(lambda rows: pieces.around(rows).sum(axis=2))
    np.testing.assert_allclose(sums, whole.around(slice(None)).sum(axis=2), atol=1e-12)


def test_a_cloud_comes_back_to_its_place(flat, dtype):
    cloud = (flat + 100).astype(dtype)
    near = Neighbourhoods.of(cloud, 500_000)
    assert near.k == len(flat) and near.points.dtype == dtype
    np.testing.assert_array_equal(near.placed(near.points), cloud)


def test_two_neighbours_are_too_few(flat):
    with pytest.raises(ValueError, match="neighbours"):
        Neighbourhoods.of(flat, 2)
