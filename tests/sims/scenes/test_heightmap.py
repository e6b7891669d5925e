"""The spline of a height map: what it reproduces, and that it is smooth."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from sims.scenes import HeightMap

CELL = 0.01


def _map(depth):
    valid = np.ones(depth.shape, dtype=bool)
    return HeightMap(
        jnp.asarray(depth), jnp.asarray(valid), jnp.asarray(-0.1), jnp.asarray(0.5), jnp.asarray(CELL)
    )


def _random_map():
    return _map(0.003 * np.random.default_rng(4).normal(size=(20, 30)))


def test_planes_are_reproduced_exactly(x64):
    v, u = np.indices((20, 30))
    surface = _map(0.2 + 0.3 * (-0.1 + CELL * u) - 0.4 * (0.5 + CELL * v))
    uv = jnp.asarray(np.random.default_rng(0).uniform(surface.lower, surface.upper, (50, 2)))
    depth, slopes = jax.jit(jax.vmap(surface.evaluate))(uv)
    np.testing.assert_allclose(depth, 0.2 + 0.3 * uv[:, 0] - 0.4 * uv[:, 1], atol=1e-12)
    np.testing.assert_allclose(slopes, np.tile([0.3, -0.4], (50, 1)), atol=1e-12)


def test_slopes_are_the_gradient_and_go_on_across_cells(x64):
    surface = _random_map()
    edges = jnp.asarray([[-0.1 + 7.5 * CELL, 0.57], [0.0, 0.5 + 9.5 * CELL], [0.033, 0.612]])
    slopes = jax.jit(jax.vmap(lambda uv: surface.evaluate(uv)[1]))
    gradient = jax.jit(jax.vmap(jax.grad(lambda uv: surface.evaluate(uv)[0])))
    for step in (-1e-9, 1e-9):
        np.testing.assert_allclose(slopes(edges + step), gradient(edges + step), atol=1e-12)
    np.testing.assert_allclose(slopes(edges - 1e-9), slopes(edges + 1e-9), atol=1e-6)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_the_type_of_the_input_is_kept(x64, dtype):
    surface = jax.tree.map(lambda leaf: leaf.astype(dtype) if leaf.dtype != bool else leaf, _random_map())
    depth, slopes = jax.jit(lambda uv: surface.evaluate(uv))(jnp.asarray([0.0, 0.6], dtype=dtype))
    assert depth.dtype == dtype and slopes.dtype == dtype
