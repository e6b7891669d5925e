"""Moving least squares: planes, quadrics, and edges that the robust form keeps."""

import numpy as np
import pytest

from jaxpaint.clouds import Edge, edge_sharpness, normal_error
from jaxpaint.refinement import MovingLeastSquaresSettings, moving_least_squares

EDGE = Edge(np.zeros(3), np.asarray([0, 1.0, 0]), np.asarray([1.0, 0, 0]), np.asarray([0, 0, 1.0]))
PLAIN = MovingLeastSquaresSettings(rounds=0)


@pytest.mark.parametrize("rounds", [0, 6])
def test_a_noisy_plane_gets_three_times_flatter(flat, rounds: int):
    inner = (np.abs(flat[:, 0] - 0.5) < 0.3) & (np.abs(flat[:, 1] - 0.4) < 0.24)
    found = moving_least_squares(flat, MovingLeastSquaresSettings(rounds=rounds))
    height = found.points @ [0, 0.6, 0.8]
    assert height[inner].std() < 0.33 * (flat @ [0, 0.6, 0.8])[inner].std()
    assert normal_error(found.normals, np.tile([0, 0.6, 0.8], (len(flat), 1)), inner).mean < 0.05


def bowl() -> tuple[np.ndarray, np.ndarray]:
    """A paraboloid without noise, and which of its points lie far from its rim."""
    rng = np.random.default_rng(7)
    x, y = rng.uniform(-1, 1, (2, 3_000))
    return np.stack([x, y, 0.4 * x * x + 0.2 * x * y], axis=1), np.maximum(abs(x), abs(y)) < 0.6


def test_order_two_follows_a_curve_that_order_one_cuts():
    points, inner = bowl()
    moved = {}
    for order in (1, 2):
        found = moving_least_squares(points, MovingLeastSquaresSettings(order=order, rounds=0))
        x, y, z = found.points[inner].T
        moved[order] = np.abs(z - 0.4 * x * x - 0.2 * x * y).mean()
    assert moved[2] < 0.1 * moved[1]


def test_normals_of_order_two_are_the_surface_s():
    points, inner = bowl()
    found = moving_least_squares(points, MovingLeastSquaresSettings(order=2, rounds=0))
    x, y, _ = points.T
    truth = np.stack([-0.8 * x - 0.2 * y, -0.2 * x, np.ones_like(x)], axis=1)
    truth /= np.linalg.norm(truth, axis=1, keepdims=True)
    assert normal_error(found.normals, truth, inner).p95 < 0.02


def test_the_robust_form_keeps_an_edge(folded):
    robust = edge_sharpness(moving_least_squares(folded).points, EDGE, reach=0.12)
    plain = edge_sharpness(moving_least_squares(folded, PLAIN).points, EDGE, reach=0.12)
    assert robust.rounding < 0.75 * plain.rounding
    assert robust.mean < 0.6 * plain.mean


@pytest.mark.parametrize(("name", "value"), [("order", 3), ("rounds", -1), ("bandwidth", 0), ("tuning", 0)])
def test_a_setting_out_of_range_is_refused(name: str, value: int):
    with pytest.raises(ValueError, match=name):
        MovingLeastSquaresSettings(**{name: value})
