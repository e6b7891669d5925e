"""Planes found by random samples: large ones first, small ones too, none twice."""

import numpy as np

from jaxpaint.refinement.plane_search import find_planes

WANTED = {"most": 9, "samples": 256, "seed": 0}


def faces() -> np.ndarray:
    """A wall z = 0 of 1,500 points and a plate x = 0.5 before it of 120."""
    rng = np.random.default_rng(0)
    wall = np.concatenate([rng.uniform(-2, 2, (2, 1_500)), np.zeros((1, 1_500))])
    y, z = rng.uniform(0, 0.2, (2, 120))
    return np.concatenate([wall, np.stack([np.full(120, 0.5), y, z + 0.5])], axis=1)


def test_a_small_face_is_found_beside_a_large_wall():
    found = find_planes(faces(), np.full(1_620, 1e-3), least=60, **WANTED)
    np.testing.assert_allclose(np.abs(found), [[0, 0, 1, 0], [1, 0, 0, 0.5]], atol=1e-12)


def test_a_plane_of_too_few_points_is_none():
    found = find_planes(faces(), np.full(1_620, 1e-3), least=200, **WANTED)
    assert found.shape == (1, 4)
    line = np.linspace(0, 1, 50) * np.ones((3, 1))
    assert find_planes(line, np.full(50, 1e-3), least=10, **WANTED).shape == (0, 4)


def test_every_point_has_its_own_limit():
    cloud = faces()
    cloud[2, :1_500] += np.random.default_rng(1).normal(0, 0.01, 1_500)
    limit = np.where(np.arange(1_620) < 1_500, 0.04, 1e-6)
    found = find_planes(cloud, limit, least=60, **WANTED)
    assert len(found) == 2
    np.testing.assert_allclose(np.abs(found[1]), [1, 0, 0, 0.5], atol=1e-9)
