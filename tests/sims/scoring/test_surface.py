"""Samples of the true surface, and how far a cloud is from them."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.clouds import chamfer
from sims.scoring import surface_samples

CHAMFER = jax.jit(chamfer)
SAMPLES = jax.jit(surface_samples, static_argnames=("columns", "rows"))


def test_small_offsets_far_from_the_origin_survive_single_precision(plane):
    chart = plane().chart
    truth = SAMPLES(chart, jnp.asarray([-1.0, 0.5]), jnp.asarray([1.0, 1.5]), columns=30, rows=15)
    cloud = truth + jnp.asarray([1e-4, 0, 0])
    found = CHAMFER(cloud, jnp.ones(450, bool), truth)
    assert found.l1 == pytest.approx(1e-4, rel=1e-3)
    assert found.l2 == pytest.approx(2e-8, rel=1e-3)


def test_samples_lie_evenly_on_the_surface(pillar):
    points = SAMPLES(pillar.chart, jnp.asarray([-0.3, 0.0]), jnp.asarray([0.3, 1.0]), columns=6, rows=4)
    assert points.shape == (24, 3)
    np.testing.assert_allclose(np.hypot(points[:, 0] - 0.5, points[:, 1]), 0.5, rtol=1e-5)
    first_row = np.asarray(points[:6])
    np.testing.assert_allclose(
        np.arctan2(-first_row[:, 1], 0.5 - first_row[:, 0]) * 0.5, np.arange(-0.25, 0.3, 0.1), atol=1e-5
    )
