"""Cells on the wall and the extent of a canvas on it."""

import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.errors import InputError
from jaxpaint.mapping.canvas import Canvas
from sims.paint import PaintGrid, canvas_extent


def test_grid_covers_the_rectangle_with_its_middle_cells_at_whole_numbers():
    grid = PaintGrid.covering(np.asarray([-0.5, 0.2]), np.asarray([0.51, 0.3]), 0.02)
    assert grid.shape == (5, 51)
    centres = np.asarray(grid.centres())
    assert centres.shape == (5, 51, 2)
    np.testing.assert_allclose(centres[0, 0], [-0.49, 0.21], atol=1e-6)
    assert centres[-1, -1, 0] + 0.01 >= 0.51 - 1e-6
    np.testing.assert_allclose(grid.to_cells(grid.centres())[3, 7], [7, 3], atol=1e-4)


def test_extent_is_the_canvas_with_its_margin(plane):
    canvas = Canvas(jnp.asarray([-1.0, 0.25, 1.0]), jnp.asarray(0.0), jnp.asarray([1.0, 0.5]))
    lower, upper = canvas_extent(plane(), canvas, margin=0.1)
    np.testing.assert_allclose(lower, [-0.85, 0.65], atol=1e-5)
    np.testing.assert_allclose(upper, [0.35, 1.35], atol=1e-5)


def test_extent_on_a_pillar_is_arc_length(pillar):
    canvas = Canvas(jnp.asarray([-1.0, 0.0, 1.0]), jnp.asarray(0.0), jnp.asarray([0.8, 0.5]))
    lower, upper = canvas_extent(pillar, canvas, margin=0.0)
    np.testing.assert_allclose([lower[0], upper[0]], [-0.5 * np.arcsin(0.8), 0.5 * np.arcsin(0.8)], atol=1e-4)


def test_extent_ends_with_the_wall(plane):
    canvas = Canvas(jnp.asarray([-1.0, -1.8, 1.0]), jnp.asarray(0.0), jnp.asarray([1.0, 0.5]))
    _, upper = canvas_extent(plane(), canvas, margin=0.1)
    assert upper[0] == 2


def test_canvas_that_looks_away_is_refused(plane):
    canvas = Canvas(jnp.asarray([-1.0, 0.0, 1.0]), jnp.asarray(np.pi), jnp.asarray([1.0, 0.5]))
    with pytest.raises(InputError, match="no ray of the canvas meets the wall"):
        canvas_extent(plane(), canvas, margin=0.1)
