"""Polynomials over tangent planes against what is known of the surface, and where nothing is."""

import numpy as np
import pytest

from jaxpaint.refinement.local_polynomials import fit_polynomials


def patch(lift: float) -> np.ndarray:
    """Points of z = 0.3 x^2 - 0.2 x y about (0, 0, -lift), one neighbourhood [3, 1, k]."""
    x, y = np.random.default_rng(0).uniform(-0.5, 0.5, (2, 60))
    return np.stack([x, y, 0.3 * x * x - 0.2 * x * y - lift])[:, None, :]


def test_a_quadric_is_met():
    # not exactly: over a plane that is tilted a little it is none of order two
    fitted = fit_polynomials(patch(0.01), np.ones((1, 60)), np.full(1, 0.3), 2)
    assert np.abs(fitted.residuals(patch(0.01))).max() < 1e-3
    step, normal = fitted.step_from_origin()
    np.testing.assert_allclose(step[:, 0], [0, 0, -0.01], atol=2e-4)
    np.testing.assert_allclose(np.abs(normal[:, 0]), [0, 0, 1], atol=0.02)


@pytest.mark.parametrize("order", [1, 2])
def test_a_line_of_points_is_left_where_it_is(order: int):
    line = np.linspace(-1, 1, 20) * np.asarray([1.0, 2.0, 0.5])[:, None]
    step, normal = fit_polynomials(line[:, None, :], np.ones((1, 20)), np.ones(1), order).step_from_origin()
    np.testing.assert_allclose(step, 0, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(normal, axis=0), 1)


@pytest.mark.parametrize("order", [1, 2])
def test_a_tilt_between_plane_and_fit_is_followed(order: int):
    around = patch(0.0)
    around[2] = 0.1 * around[0] + 0.02
    step, _ = fit_polynomials(around, np.ones((1, 60)), np.full(1, 0.3), order).step_from_origin()
    np.testing.assert_allclose(step[:, 0], 0.02 / 1.01 * np.asarray([-0.1, 0, 1]), atol=1e-6)
