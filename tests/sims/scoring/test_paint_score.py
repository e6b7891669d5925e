"""Scores of pictures whose faults are known."""

from dataclasses import astuple
from types import SimpleNamespace

import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.mapping.canvas import Canvas
from sims.paint import PaintGrid
from sims.scoring import score_paint, score_paint_worlds, wanted_area

FILM = 60e-6
EXTENT = np.asarray([-0.6, -0.2]), np.asarray([0.6, 0.2])
CANVAS = Canvas(jnp.asarray([-1.0, 0.0, 0.0]), jnp.asarray(0.0), jnp.asarray([1.2, 0.4]))


@pytest.fixture
def wall(plane):
    """A wanted line 0.8 m long and 20 mm wide, and a grid of 2 mm for the paint."""
    wanted = wanted_area([np.asarray([[-0.4, 0.0], [0.4, 0.0]])], plane(), CANVAS, EXTENT, 0.010)
    return SimpleNamespace(wanted=wanted, grid=PaintGrid.covering(*EXTENT, 0.002))


def band(grid, start=-0.4, stop=0.4, v=0.0, half=0.010, film=FILM):
    """Paint of even thickness on a rectangle."""
    uv = np.asarray(grid.centres())
    inside = (uv[..., 0] >= start) & (uv[..., 0] <= stop) & (np.abs(uv[..., 1] - v) <= half)
    return film * inside


def sweep(start=-0.4, stop=0.4, v=0.0, steps=300):
    return np.stack([np.linspace(start, stop, steps), np.full(steps, v)], axis=-1)


def score(wall, thickness, uv, down=None, **others):
    down = np.ones(len(uv), bool) if down is None else down
    return score_paint(wall.wanted, wall.grid, thickness, uv, down, film=FILM, **others)


def test_perfect_paint(wall):
    found = score(wall, band(wall.grid, -0.41, 0.41), sweep())
    assert found.coverage > 0.99
    assert found.excess == 0
    assert found.thickness_cv < 0.2
    assert found.gap_length == 0
    assert found.stroke_error_mean < 5e-4
    assert found.stroke_error_p95 < 1.1e-3


def test_paint_beside_the_line(wall):
    found = score(wall, band(wall.grid, v=0.008), sweep(v=0.008))
    # The band's edge lies up to half a cell of the paint grid further out where paint is interpolated.
    assert found.coverage == pytest.approx(12.5 / 20, abs=0.03)
    # 18 mm above the line the paint ends; 15 mm above it excess begins.
    assert found.excess == pytest.approx(0.0035 * 0.8 / wall.wanted.area, rel=0.2)
    assert found.stroke_error_mean == pytest.approx(0.008, abs=5e-4)


def test_what_was_left_out_counts_as_missed(wall):
    found = score(wall, band(wall.grid, stop=0.0), sweep(stop=0.0))
    assert found.coverage == pytest.approx(0.5, abs=0.02)
    # No paint comes after the bare half, so it is no gap between two stretches.
    assert found.gap_length == 0
    # Nothing is wrong one way; the other way the bare half is 0 to 0.4 m from the brush.
    assert found.stroke_error_mean == pytest.approx(0.5 * 0.5 * 0.2, rel=0.02)
    assert found.stroke_error_p95 == pytest.approx(0.32, rel=0.02)


def test_gap_between_two_stretches(wall):
    thickness = band(wall.grid, stop=-0.05) + band(wall.grid, start=0.05)
    assert score(wall, thickness, sweep()).gap_length == pytest.approx(0.1, abs=0.004)


def test_thin_paint_is_no_paint(wall):
    assert score(wall, band(wall.grid, film=0.19 * FILM), sweep()).coverage == 0
    assert score(wall, band(wall.grid, film=0.21 * FILM), sweep()).coverage > 0.85


def test_thickness_variation(wall):
    thickness = band(wall.grid, stop=-0.001) + band(wall.grid, start=0.001, film=3 * FILM)
    assert score(wall, thickness, sweep()).thickness_cv == pytest.approx(0.5, abs=0.05)


def test_stray_paint_is_excess(wall):
    clean = score(wall, band(wall.grid), sweep())
    stray = score(wall, band(wall.grid), sweep(), stray=FILM * 0.004)
    assert stray.excess - clean.excess == pytest.approx(0.004 / wall.wanted.area)


def test_pen_up_and_dwelling_do_not_count_for_the_stroke_error(wall):
    there, away, back = sweep(stop=0.0), sweep(0.0, 0.0, v=0.15), sweep(0.0, 0.4)
    uv = np.concatenate([there, away, np.repeat(back[:1], 5000, axis=0), back])
    down = np.concatenate([np.ones(300, bool), np.zeros(300, bool), np.ones(5300, bool)])
    assert score(wall, band(wall.grid), uv, down).stroke_error_mean < 5e-4
    uv_off, down_off = np.concatenate([sweep(v=0.01), np.full((5000, 2), [0.0, 0.0])]), np.ones(5300, bool)
    assert score(wall, band(wall.grid), uv_off, down_off).stroke_error_p95 == pytest.approx(0.01, abs=1e-3)


def test_no_paint_at_all(wall):
    found = score(wall, band(wall.grid) * 0, sweep(), np.zeros(300, bool))
    assert (found.coverage, found.excess, found.gap_length) == (0, 0, 0)
    assert np.isnan([found.thickness_cv, found.stroke_error_mean, found.stroke_error_p95]).all()


def test_broken_samples_are_left_out(wall):
    uv, thickness = sweep(), band(wall.grid)
    uv[100:110] = np.nan
    thickness[0, 0] = np.nan
    assert np.isfinite(astuple(score(wall, thickness, uv))).all()


def test_many_worlds_are_each_world(wall):
    thickness = np.stack([band(wall.grid, v=v) for v in (0.0, 0.004, 0.02)])
    uv = np.stack([sweep(v=v) for v in (0.0, 0.004, 0.02)])
    down, stray = np.ones((3, 300), bool), np.asarray([0, FILM * 0.001, 0])
    many = score_paint_worlds(wall.wanted, wall.grid, thickness, uv, down, film=FILM, stray=stray)
    for world in range(3):
        assert many[world] == score(wall, thickness[world], uv[world], stray=stray[world])
    assert many[0].coverage > many[1].coverage > many[2].coverage
