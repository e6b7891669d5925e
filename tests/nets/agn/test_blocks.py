"""Blocks of neighbours: every point in one, all of a size, compact."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from nets.agn import BLOCK, block_order, padded_size

ORDER = jax.jit(block_order)


@pytest.mark.parametrize(
    ("count", "size"), [(1, 8), (8, 8), (9, 16), (1000, 1024), (1024, 1024), (1025, 2048)]
)
def test_sizes_are_powers_of_two(count, size):
    assert padded_size(count) == size


def test_every_point_is_in_one_block():
    points = np.random.default_rng(0).standard_normal((256, 3))
    order = ORDER(jnp.asarray(points), jnp.ones(256, bool))
    np.testing.assert_array_equal(np.sort(order), np.arange(256))


def test_runs_of_every_length_are_compact():
    """Of points on a square, runs are rectangles that share it out: as wide as their number says."""
    points = np.zeros((4096, 3))
    points[:, :2] = np.random.default_rng(1).random((4096, 2))
    placed = points[np.asarray(ORDER(jnp.asarray(points), jnp.ones(4096, bool)))]
    for run in (BLOCK, 64, 512):
        parts = placed.reshape(-1, run, 3)
        wide = np.ptp(parts, axis=1).max(1)
        assert np.median(wide) < 1.5 * (run / 4096) ** 0.5


def test_what_is_not_there_fills_blocks_of_its_own():
    points = np.random.default_rng(2).standard_normal((256, 3))
    valid = np.random.default_rng(3).random(256) < 0.4
    blocks = valid[np.asarray(ORDER(jnp.asarray(points), jnp.asarray(valid)))].reshape(-1, BLOCK)
    mixed = blocks.any(1) & ~blocks.all(1)
    assert blocks.any(1).sum() <= -(-valid.sum() // BLOCK) + 1 and mixed.sum() <= 1
    assert (np.diff(blocks.any(1).astype(int)) <= 0).all()


def test_points_that_coincide_are_shared_out_all_the_same():
    order = ORDER(jnp.ones((64, 3)), jnp.ones(64, bool))
    np.testing.assert_array_equal(np.sort(order), np.arange(64))


@pytest.mark.parametrize("count", [4, 24])
def test_other_sizes_are_refused(count):
    with pytest.raises(ValueError, match="power of two"):
        block_order(jnp.zeros((count, 3)), jnp.ones(count, bool))
