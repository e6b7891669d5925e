"""A few points stand for a cloud, without holes between them."""

import jax.numpy as jnp
import numpy as np
from scipy.spatial import KDTree

from jaxpaint.clouds.sparse import sparse

# A wall as a camera sees it: row by row, thousands in each.
ROWS = np.stack(np.meshgrid([0.0], np.linspace(-1, 1, 400), np.linspace(0, 1, 100)), -1).reshape(-1, 3)
VALID = jnp.ones(len(ROWS), bool)


def farthest(cloud, some) -> float:
    """How far a point of the cloud can be from the nearest of the few [m]."""
    return KDTree(some[np.isfinite(some).all(-1)]).query(cloud)[0].max()


def test_what_is_left_is_evenly_spread():
    some = np.asarray(sparse(jnp.asarray(ROWS), VALID, count=200, size=0.02))
    assert np.isfinite(some).all()
    assert len(np.unique(some, axis=0)) == 200
    # squares of 0.1 m for each of 200 would have corners 0.07 m from their middles
    assert farthest(ROWS, some) < 0.15
    assert farthest(ROWS, ROWS[:: len(ROWS) // 200]) > 0.3


def test_all_cubes_are_kept_where_there_is_room():
    some = np.asarray(sparse(jnp.asarray(ROWS), VALID, count=300, size=0.1))
    real = some[np.isfinite(some).all(-1)]
    assert 200 <= len(real) <= 21 * 11
    assert np.isnan(some[len(real) :]).all()
    assert farthest(ROWS, real) < 0.1 * np.sqrt(2)


def test_only_valid_points_are_taken():
    cloud = jnp.asarray(ROWS).at[7].set(jnp.nan)
    some = np.asarray(sparse(cloud, VALID & (cloud[:, 1] > 0.5), count=64, size=0.05))
    assert (some[:, 1] > 0.5).all()
    assert np.isnan(np.asarray(sparse(cloud, ~VALID, count=8, size=0.05))).all()
