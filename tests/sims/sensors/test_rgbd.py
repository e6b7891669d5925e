"""Noiseless pictures of known walls."""

import jax
import jax.numpy as jnp
import numpy as np

from sims.sensors import Camera, back_project, render
from sims.sensors.camera import rotate

RENDER = jax.jit(render)
CAMERA = Camera(width=40, height=30, cx=19.5, cy=14.5, fx=30.0, fy=30.0)


def yawed(R_map_camera, angle):
    c, s = np.cos(angle), np.sin(angle)
    return jnp.asarray([[c, -s, 0.0], [s, c, 0], [0, 0, 1]]) @ R_map_camera


def test_depth_is_along_the_optical_axis(plane, R_map_camera):
    picture = RENDER(plane(), CAMERA, jnp.asarray([-1.25, 0.3, 1]), R_map_camera)
    assert picture.valid.all()
    np.testing.assert_allclose(picture.depth, 1.25, rtol=1e-6)


def test_points_of_a_slanted_view_lie_on_the_wall(plane, R_map_camera):
    position, R = jnp.asarray([-1.0, 0.3, 1]), yawed(R_map_camera, 0.4)
    picture = RENDER(plane(), CAMERA, position, R)
    cloud = position + rotate(R, back_project(CAMERA, picture.depth))
    assert picture.valid.all()
    np.testing.assert_allclose(cloud[:, 0], 0, atol=1e-6)
    assert np.ptp(cloud[:, 1]) > 1


def test_incidence_is_the_cosine_to_the_normal(plane, R_map_camera):
    picture = RENDER(plane(), CAMERA, jnp.asarray([-1.0, 0, 1]), R_map_camera)
    offset = 19.5 / 30, 14.5 / 30
    corner = 1 / np.sqrt(1 + offset[0] ** 2 + offset[1] ** 2)
    np.testing.assert_allclose(picture.incidence[0, 0], corner, rtol=1e-5)
    np.testing.assert_allclose(picture.colour, 0.5)


def test_nothing_is_seen_out_of_range_or_away_from_the_wall(plane, R_map_camera):
    for x, R in ((-0.1, R_map_camera), (-7.0, R_map_camera), (-1.0, yawed(R_map_camera, np.pi))):
        picture = RENDER(plane(), CAMERA, jnp.asarray([x, 0, 1]), R)
        assert not picture.valid.any()
        assert (np.asarray(picture.depth) == 0).all()
