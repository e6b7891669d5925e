"""The pinhole model against its definition."""

import jax.numpy as jnp
import numpy as np
import pytest

from sims.sensors import Camera, back_project, pixel_rays


def test_default_is_a_d435_decimated_by_four():
    camera = Camera()
    same = Camera.with_field_of_view(848 // 4, 480 // 4, np.radians(87), np.radians(58))
    for name in ("fx", "fy", "cx", "cy"):
        assert getattr(camera, name) == pytest.approx(float(getattr(same, name)), rel=1e-4)


def test_outer_edges_of_the_image_span_the_field_of_view():
    camera = Camera()
    rays = np.asarray(pixel_rays(camera))
    half_pixel = 0.5 / float(camera.fx)
    assert 2 * np.degrees(np.arctan(rays[0, -1, 0] + half_pixel)) == pytest.approx(87, abs=0.01)
    assert rays[0, 0, 0] < 0 < rays[0, -1, 0], "x grows to the right"
    assert rays[0, 0, 1] < 0 < rays[-1, 0, 1], "y grows downwards"


def test_back_projection_undoes_projection():
    camera = Camera(width=7, height=5, cx=2.5, cy=1.5)
    depth = 1 + jnp.arange(35.0).reshape(5, 7) / 10
    points = np.asarray(back_project(camera, depth))
    column = points[:, 0] / points[:, 2] * float(camera.fx) + 2.5
    row = points[:, 1] / points[:, 2] * float(camera.fy) + 1.5
    np.testing.assert_allclose(column.reshape(5, 7), np.tile(np.arange(7), (5, 1)), atol=1e-4)
    np.testing.assert_allclose(row.reshape(5, 7), np.tile(np.arange(5)[:, None], (1, 7)), atol=1e-4)
    np.testing.assert_allclose(points[:, 2].reshape(5, 7), depth)


def test_impossible_field_of_view_is_refused():
    with pytest.raises(ValueError, match="field of view"):
        Camera.with_field_of_view(10, 10, 4.0, 1.0)
