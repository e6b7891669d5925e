"""The wanted area of simple lines on simple walls."""

import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.errors import InputError
from jaxpaint.mapping.canvas import Canvas
from sims.scoring import wanted_area
from sims.scoring.ground import CELL
from sims.scoring.lines import densify

CANVAS = Canvas(jnp.asarray([-1.0, 0.0, 0.0]), jnp.asarray(0.0), jnp.asarray([1.2, 0.6]))
LINE = np.asarray([[-0.4, 0.0], [0.4, 0.0]])
EXTENT = np.asarray([-0.6, -0.2]), np.asarray([0.6, 0.2])


def at(wanted, picture, u, v):
    return picture.ravel()[wanted.index(np.asarray([[u, v]]))[0]]


def test_line_on_a_flat_wall(plane):
    wanted = wanted_area([LINE], plane(), CANVAS, EXTENT, 0.010)
    assert wanted.ground.shape == (400, 1200)
    assert wanted.area == pytest.approx(0.8 * 0.02 + np.pi * 0.01**2, rel=0.01)
    assert at(wanted, wanted.layers[0].centre_distance, 0.1, 0.0705) == pytest.approx(0.07, abs=0.001)
    assert at(wanted, wanted.layers[0].centre_distance, 0.5, 0.0) == pytest.approx(0.1, abs=0.001)
    assert at(wanted, wanted.mask, 0.3, 0.008)
    assert not at(wanted, wanted.mask, 0.3, 0.012)


def test_slanted_line_is_widened_to_the_same_brush(plane):
    slanted = np.asarray([[-0.3, -0.1], [0.3, 0.1]])
    wanted = wanted_area([slanted], plane(), CANVAS, EXTENT, 0.010)
    length = np.hypot(0.6, 0.2)
    assert wanted.area == pytest.approx(length * 0.02 + np.pi * 0.01**2, rel=0.005)


def test_line_on_a_pillar_has_its_arc_length(pillar):
    wanted = wanted_area([LINE], pillar, CANVAS, EXTENT, 0.010)
    arc = 2 * 0.5 * np.arcsin(0.4 / 0.5)
    (line,) = wanted.lines
    assert np.linalg.norm(np.diff(line, axis=0), axis=1).sum() == pytest.approx(arc, rel=1e-3)
    assert wanted.area == pytest.approx(arc * 0.02 + np.pi * 0.01**2, rel=0.005)


def test_hole_in_the_wall_cuts_the_line_and_the_area(plane):
    whole = wanted_area([LINE], plane(), CANVAS, EXTENT, 0.010)
    holed = wanted_area([LINE], plane(hole=0.2), CANVAS, EXTENT, 0.010)
    assert len(holed.lines) == 1
    assert holed.lines[0][:, 0].max() == pytest.approx(0.3, abs=0.001)
    assert not at(holed, holed.on_surface, 0.35, 0.0)
    assert whole.area - holed.area == pytest.approx(0.1 * 0.02 + 0.5 * np.pi * 0.01**2, rel=0.1)


def test_line_that_jumps_to_another_sheet_is_cut(plane):
    class Torn(type(plane().chart)):
        """Right of u = 0.1 the chart goes on 0.2 m further."""

        def to_uv(self, p):
            uv, height = super().to_uv(p)
            return uv + jnp.where(uv[0] > 0.1, jnp.asarray([0.2, 0.0]), 0), height

    scene = plane()
    torn = type(scene)(Torn(scene.chart.lower, scene.chart.upper, 0.0), 0.5)
    wanted = wanted_area([LINE], torn, CANVAS, (np.asarray([-0.6, -0.1]), np.asarray([0.7, 0.1])), 0.010)
    assert [round(float(np.ptp(line[:, 0])), 2) for line in wanted.lines] == [0.5, 0.3]
    assert not at(wanted, wanted.mask, 0.2, 0.0)


def test_lines_past_the_wall_are_an_error(plane):
    away = Canvas(jnp.asarray([-1.0, 0.0, 0.0]), jnp.asarray(np.pi), jnp.asarray([1.2, 0.6]))
    with pytest.raises(InputError, match="no ink of the picture meets the wall"):
        wanted_area([LINE], plane(), away, EXTENT, 0.010)


def test_densify_keeps_the_line_and_its_ends():
    bent = np.asarray([[0.0, 0.0], [0.3, 0.0], [0.3, 0.1]])
    dense = densify(bent, CELL)
    assert len(dense) == 401
    np.testing.assert_allclose(dense[[0, -1]], bent[[0, -1]])
    np.testing.assert_allclose(dense[300], bent[1], atol=1e-9)
    assert np.linalg.norm(np.diff(dense, axis=0), axis=1).max() <= CELL + 1e-12


def test_a_single_point_stays_a_point():
    np.testing.assert_array_equal(densify(np.asarray([[0.1, 0.2]]), CELL), [[0.1, 0.2]] * 2)
