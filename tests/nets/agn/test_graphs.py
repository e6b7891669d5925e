"""Who sees whom."""

import jax.numpy as jnp
import numpy as np

from nets.agn import BLOCK, block_order
from nets.agn.graphs import alike, near

RNG = np.random.default_rng(0)


def anchors(count):
    points = RNG.random((count * BLOCK, 3)) * [1, 1, 0.1]
    order = np.asarray(block_order(jnp.asarray(points), jnp.ones(len(points), bool)))
    return points[order].reshape(count, BLOCK, 3).mean(1)


def test_the_nearest_anchors_in_space_are_found():
    centres = anchors(128)
    graph = near(jnp.asarray(centres), jnp.ones(128, bool), 6, 8)
    square = ((centres[:, None] - centres) ** 2).sum(-1)
    expected = np.sort(square, axis=1)[:, :6]
    found = np.take_along_axis(square, np.asarray(graph.index), axis=1)
    assert graph.real.all() and (graph.index[:, 0] == np.arange(128)).all()
    # By groups some far ones may be missed, which few are.
    assert np.isclose(found, expected, atol=1e-6).mean() > 0.95


def test_anchors_without_points_are_nobodys_neighbours():
    centres, valid = anchors(64), np.arange(64) < 10
    graph = near(jnp.asarray(centres), jnp.asarray(valid), 12, 4)
    index, real = np.asarray(graph.index), np.asarray(graph.real)
    assert (index[real] < 10).all() and not real[10:].any()
    assert (real[:10].sum(1) == 10).all()


def test_in_feature_space_the_same_plane_is_near_however_far():
    """Two walls with a step of five times the noise between them."""
    noise, count = 0.01, 128
    centres = np.zeros((count, 3))
    centres[:, :2] = RNG.uniform(-3, 3, (count, 2))
    upper = np.arange(count) % 2 == 0
    centres[:, 2] = 0.05 * upper + 0.1 * noise * RNG.standard_normal(count)
    # Every group has one of each wall only where the smoothest is drawn at random.
    rough = np.where(np.arange(count) // 8 % 2 == upper, 1.0, 2.0)
    normals = np.tile([0.0, 0.0, 1.0], (count, 1))
    args = (centres, normals, rough, np.full(count, noise), np.ones(count, bool))
    graph = alike(jnp.asarray(centres / 10), *map(jnp.asarray, args), 4)
    assert graph.real.all()
    assert (upper[np.asarray(graph.index)] == upper[:, None]).all()


def test_edges_may_be_picked():
    graph = near(jnp.asarray(anchors(64)), jnp.ones(64, bool), 6, 4)
    assert graph.columns(slice(2)).index.shape == (64, 2)
