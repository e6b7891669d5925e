import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.clouds.neighbours import bin_points

SIZE = 0.02


@pytest.fixture(scope="module")
def cloud() -> np.ndarray:
    rng = np.random.default_rng(0)
    return rng.uniform((-0.3, -0.2, 0.1), (0.3, 0.2, 0.9), (4000, 3)).astype(np.float32)


def binned(cloud, valid=None):
    valid = np.ones(len(cloud), bool) if valid is None else valid
    return jax.jit(bin_points)(
        jnp.asarray(cloud), jnp.asarray(valid), jnp.array([-0.4, -0.3]), jnp.asarray(SIZE)
    )


def taken(cells, uv, reach, near, far, most):
    points, real = cells.take(*cells.between(jnp.asarray(uv), reach, near, far), most)
    return np.asarray(points).T[np.asarray(real)]


@pytest.mark.parametrize("reach", [1, 3])
def test_every_point_within_reach_is_found(cloud, reach):
    cells = binned(cloud)
    for uv in ((0.0, 0.0), (0.123, -0.081), (-0.299, 0.199)):
        close = np.linalg.norm(cloud[:, :2] - uv, axis=1) < reach * SIZE
        wanted = cloud[close & (cloud[:, 2] > 0.3) & (cloud[:, 2] < 0.5)]
        found = taken(cells, uv, reach, 0.3, 0.5, 64)
        distance = np.linalg.norm(found[:, None] - wanted[None], axis=-1).min(0)
        assert len(wanted) > 0 and distance.max() == 0
        assert np.all((found[:, 2] > 0.298) & (found[:, 2] < 0.502))
        assert len(np.unique(found, axis=0)) == len(found)


def test_a_full_cell_is_thinned_over_its_depth():
    depth = np.linspace(0.1, 0.9, 101, dtype=np.float32)
    line = np.stack([np.full(101, 0.005), np.full(101, 0.005), depth], -1).astype(np.float32)
    found = taken(binned(line), (0.005, 0.005), 1, -jnp.inf, jnp.inf, 8)
    np.testing.assert_allclose(np.sort(found[:, 2]), np.linspace(0.15, 0.85, 8), atol=0.01)


def test_missing_invalid_and_far_points_are_left_out(cloud):
    valid = np.arange(len(cloud)) % 2 == 0
    spoilt = cloud.copy()
    spoilt[::4, 1] = np.nan
    spoilt[2::8, 0] = 1e9
    cells = binned(spoilt, valid)
    everything = taken(cells, (0.0, 0.0), 20, -jnp.inf, jnp.inf, 64)
    assert len(everything) == len(cloud) // 8
    assert np.isfinite(everything).all()


def test_an_empty_cloud_has_no_neighbours():
    cells = binned(np.full((10, 3), np.nan, np.float32))
    assert len(taken(cells, (0.0, 0.0), 3, 0.0, 1.0, 4)) == 0
