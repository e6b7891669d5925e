"""Sharp and rounded corners of known radius, between faces at several angles, anywhere in space."""

from math import pi

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from jaxpaint.clouds import Edge, edge_sharpness

TURN = Rotation.from_rotvec([0.4, -1.1, 0.3]).as_matrix()
PLACE = np.asarray([3.0, -2.0, 1.0])
REACH = 0.1


def corner(theta: float, radius: float, count: int = 3_000) -> tuple[np.ndarray, Edge]:
    """Points of a corner with a fillet, evenly over the profile as seen from the bisector, and its edge."""
    rng = np.random.default_rng(5)
    s = rng.uniform(-0.2, 0.2, count)
    round_ = np.abs(s) < radius * np.cos(theta)
    arc = radius / np.sin(theta) - np.sqrt(radius**2 - np.where(round_, s, 0) ** 2)
    c = np.where(round_, arc, np.abs(s) / np.tan(theta))
    points = np.stack([c, s, rng.uniform(0, 1, count)], axis=1)
    faces = [np.asarray([np.cos(theta), side * np.sin(theta), 0]) for side in (1, -1)]
    edge = Edge(PLACE, PLACE + TURN @ np.asarray([0, 0, 1.0]), TURN @ faces[0], TURN @ faces[1])
    return points @ TURN.T + PLACE, edge


@pytest.mark.parametrize("theta", [pi / 6, pi / 4, pi / 3])
def test_a_sharp_edge_has_no_rounding(theta: float):
    points, edge = corner(theta, 0.0)
    found = edge_sharpness(points, edge, reach=REACH)
    assert edge.half_angle == pytest.approx(theta)
    assert found.mean < 1e-12 and found.p95 < 1e-12 and abs(found.depth) < 1e-12
    assert abs(found.rounding) < 1e-6
    assert found.count > 500


@pytest.mark.parametrize("theta", [pi / 6, pi / 4, pi / 3])
@pytest.mark.parametrize("radius", [0.02, 0.05])
def test_a_fillet_has_its_radius(theta: float, radius: float):
    points, edge = corner(theta, radius)
    found = edge_sharpness(points, edge, reach=REACH)
    assert found.rounding == pytest.approx(radius, rel=0.04)
    assert 0.4 < found.depth / (radius * (1 / np.sin(theta) - 1)) <= 1
    assert 0 < found.mean < found.p95 < radius


def test_points_outside_of_the_edge_count_against_it():
    points, edge = corner(pi / 4, 0.03)
    sharp, _ = corner(pi / 4, 0.0)
    beyond = sharp - (points - sharp)
    assert edge_sharpness(beyond, edge, reach=REACH).rounding == pytest.approx(-0.03, rel=0.04)


def test_uneven_density_hardly_counts():
    points, edge = corner(pi / 4, 0.04)
    side = (points - PLACE) @ (edge.first - edge.second) > 0
    uneven = np.concatenate([points[side], points[~side][::5]])
    assert edge_sharpness(uneven, edge, reach=REACH).rounding == pytest.approx(0.04, rel=0.05)


def test_noise_moves_the_distances_more_than_the_rounding():
    points, edge = corner(pi / 4, 0.0)
    noisy = points + np.random.default_rng(2).normal(0, 0.003, points.shape)
    found = edge_sharpness(noisy, edge, reach=REACH)
    assert found.mean == pytest.approx(0.003 * np.sqrt(2 / pi), rel=0.1)
    assert -0.012 < found.rounding < 0.005


def test_too_few_points_give_no_figure():
    points, edge = corner(pi / 4, 0.0, count=8)
    found = edge_sharpness(points, edge, reach=REACH)
    assert found.count <= 8 and np.isnan(found.rounding)


def test_what_is_no_edge_is_refused():
    points, edge = corner(pi / 4, 0.0)
    with pytest.raises(ValueError, match="reach"):
        edge_sharpness(points, edge, reach=0.0)
    with pytest.raises(ValueError, match="faces"):
        edge_sharpness(points, Edge(edge.start, edge.end, edge.first, -edge.first), reach=REACH)
