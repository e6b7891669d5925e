"""Views become one cloud, with the errors of the believed poses."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.mapping.canvas import Canvas
from sims.sensors import Camera, crop_to_canvas, merge_views, render, thin

MERGE = jax.jit(merge_views)
CROP = jax.jit(crop_to_canvas)
THIN = jax.jit(thin, static_argnums=2)
CAMERA = Camera(width=20, height=12, cx=9.5, cy=5.5, fx=12.0, fy=12.0)
POSITIONS = jnp.asarray([[-1.0, 0.5, 1.0], [-1.2, -0.5, 1.0]])


@pytest.fixture
def views(plane, R_map_camera):
    """Two pictures of the wall x = 0, and where they were really taken."""
    R = jnp.broadcast_to(R_map_camera, (2, 3, 3))
    pictures = jax.jit(jax.vmap(lambda p, r: render(plane(), CAMERA, p, r)))(POSITIONS, R)
    return pictures, R


def test_true_poses_put_all_views_on_the_wall(views):
    pictures, R = views
    cloud, valid = MERGE(CAMERA, pictures.depth, pictures.valid, POSITIONS, R)
    assert cloud.shape == (480, 3)
    assert valid.all()
    np.testing.assert_allclose(cloud[:, 0], 0, atol=1e-6)
    assert cloud[:, 1].max() > 1
    assert cloud[:, 1].min() < -1


def test_errors_of_believed_poses_become_errors_of_the_cloud(views):
    pictures, R = views
    true, _ = MERGE(CAMERA, pictures.depth, pictures.valid, POSITIONS, R)
    shift, turn = np.asarray([[0.005, 0.01, 0], [0, 0, 0]]), 0.02
    turned = R.at[1].set(
        jnp.asarray([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]]) @ R[1]
    )
    believed, _ = MERGE(CAMERA, pictures.depth, pictures.valid, POSITIONS + shift, turned)
    moved = np.asarray(believed - true).reshape(2, -1, 3)
    np.testing.assert_allclose(moved[0], np.broadcast_to(shift[0], moved[0].shape), atol=1e-6)
    lever = np.asarray(true).reshape(2, -1, 3)[1] - np.asarray(POSITIONS[1])
    np.testing.assert_allclose(moved[1][:, 0], -turn * lever[:, 1], atol=1e-3)


def test_crop_keeps_the_box_around_the_canvas():
    canvas = Canvas(jnp.asarray([-0.5, 0.0, 1.0]), jnp.asarray(0.0), jnp.asarray([1.0, 0.6]))
    inside, beside, above, behind, hole = [0, 0.55, 1], [0, 0.65, 1], [0, 0, 1.45], [3, 0, 1], [0, 0, 1]
    cloud = jnp.asarray([inside, beside, above, behind, hole], float)
    valid = jnp.asarray([True, True, True, True, False])
    kept = CROP(cloud, valid, canvas, margin=0.1)
    np.testing.assert_array_equal(kept, [True, False, False, False, False])


@pytest.mark.parametrize("count", [0, 5, 64, 200, 1000])
def test_thinning_keeps_valid_points_evenly_and_once(count):
    rng = np.random.default_rng(count)
    valid = np.zeros(1000, bool)
    valid[rng.permutation(1000)[:count]] = True
    cloud = np.where(valid[:, None], np.arange(1000)[:, None] * np.ones(3), np.nan)
    kept, filled = (np.asarray(x) for x in THIN(jnp.asarray(cloud), jnp.asarray(valid), 64))
    assert kept.shape == (64, 3)
    assert filled.sum() == min(count, 64)
    assert (kept[~filled] == 0).all()
    index = kept[filled, 0]
    assert valid[index.astype(int)].all()
    assert len(np.unique(index)) == len(index)
    if count > 64:
        ranks = np.searchsorted(np.flatnonzero(valid), index)
        assert np.diff(ranks).max() <= np.ceil(count / 64)
        assert ranks[-1] >= count - np.ceil(count / 64)
