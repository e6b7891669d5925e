"""Colours of any look are those of the textures that they stand for, painted after the picture or within."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from sims.scans.colours import random_textures
from sims.scans.painted import render_painted
from sims.scenes import Plain, objects
from sims.sensors import Camera, render

CAMERA = Camera(width=24, height=16, cx=11.5, cy=7.5, fx=20.0, fy=20.0)


def test_looks_are_those_of_the_textures():
    draws = jax.random.uniform(jax.random.key(0), (40, 14))
    uv = jax.random.uniform(jax.random.key(1), (300, 2), minval=-1, maxval=1)
    seen = set()
    for texture in random_textures(jnp.asarray(1.2), draws):
        same = Plain(texture.first), texture.plaster, texture.checker, texture.bricks
        np.testing.assert_allclose(
            jax.vmap(texture.colour)(uv), jax.vmap(same[int(texture.look)].colour)(uv), atol=1e-6
        )
        seen.add(int(texture.look))
    assert seen == {0, 1, 2, 3}


@jax.jit
def _both(scene, pose):
    return render(scene, CAMERA, pose.p, pose.R), render_painted(scene, CAMERA, pose.p, pose.R)


def test_painting_after_the_picture_changes_nothing(batch):
    samples = batch.of("objects")
    for index in range(8):
        scene, pose = jax.tree.map(lambda x, index=index: x[index], (samples.scene, samples.T_map_camera))
        plain, painted = _both(scene, pose)
        np.testing.assert_array_equal(plain.valid, painted.valid)
        np.testing.assert_allclose(plain.depth, painted.depth, rtol=1e-6)
        same = np.abs(np.asarray(plain.colour - painted.colour)).max(2) < 1e-3
        assert same.mean() > 0.98, "but for rounding at the edges of patterns"


def test_other_textures_are_refused(R_map_camera):
    with pytest.raises(ValueError, match=r"scene: all textures are AnyTexture; found .*Plaster"):
        render_painted(objects(), CAMERA, jnp.asarray([-1.5, 0, 1]), R_map_camera)
