"""Scores of filled areas whose faults are known in closed form, on several walls."""

import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.mapping.canvas import Canvas
from jaxpaint.pictures.drawing import Area, Drawing
from sims.paint import PaintGrid, canvas_extent
from sims.scenes.walls import corner, cylinder
from sims.scoring import score_paint, wanted_area
from sims.scoring.ground import CELL

FILM = 60e-6
RADIUS = 0.010
CANVAS = Canvas(jnp.asarray([-1.0, 0.0, 0.0]), jnp.asarray(0.0), jnp.asarray([0.8, 0.6]))
NOT_DOWN = np.zeros((4, 2)), np.zeros(4, bool)
DISC = 0.15


def circle(radius=DISC, middle=(0.0, 0.0), points=900):
    angle = np.linspace(0, 2 * np.pi, points)
    return np.asarray(middle) + radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def box(left, low, right, top):
    return np.asarray([[left, low], [right, low], [right, top], [left, top], [left, low]], float)


def drawing(*areas, lines=(), line_colours=None, colours=1):
    """Areas as (rings, colour)."""
    return Drawing(
        lines=tuple(np.asarray(line, float) for line in lines),
        line_colours=tuple(line_colours or [0] * len(lines)),
        areas=tuple(Area(tuple(rings), colour) for rings, colour in areas),
        colours=tuple((0.1 * k, 0.2, 0.3) for k in range(colours)),
        name="made up",
    )


def posed(picture, scene, canvas=CANVAS, **how):
    """Wanted, and a paint grid of 1.25 mm whose cells do not meet those of the scores."""
    extent = canvas_extent(scene, canvas, margin=0.02)
    return wanted_area(picture, scene, canvas, extent, RADIUS, **how), PaintGrid.covering(*extent, 0.00125)


def soft(distance):
    """Film that passes 20 % of the nominal where a signed distance [m] is zero, over a rim of 4 mm."""
    return FILM * np.clip(0.2 - distance / 0.005, 0, 1)


def disc_film(grid, radius=DISC, middle=(0.0, 0.0)):
    return soft(np.linalg.norm(np.asarray(grid.centres(), float) - middle, axis=-1) - radius)


def score(wanted, grid, film, swept=NOT_DOWN, **others):
    return score_paint(wanted, grid, film, *swept, film=FILM, **others)


def test_a_disc_painted_as_wanted(plane):
    wanted, grid = posed(drawing(([circle()], 0)), plane())
    assert wanted.area == pytest.approx(np.pi * DISC**2, rel=2e-3)
    assert wanted.layers[0].edge_length == pytest.approx(2 * np.pi * DISC, rel=2e-3)
    found = score(wanted, grid, disc_film(grid))
    assert found.coverage > 0.998
    assert found.excess == 0
    assert found.gap_length == 0
    assert found.stroke_error_mean < 3e-4


@pytest.mark.parametrize("offset", [0.004, 0.02])
def test_a_disc_painted_beside_itself(plane, offset):
    wanted, grid = posed(drawing(([circle()], 0)), plane())
    found = score(wanted, grid, disc_film(grid, middle=(offset, 0.0)))
    assert found.stroke_error_mean == pytest.approx(2 * offset / np.pi, rel=0.04, abs=1e-4)
    lens = 2 * DISC**2 * np.arccos(offset / (2 * DISC)) - 0.5 * offset * np.sqrt(4 * DISC**2 - offset**2)
    assert found.coverage == pytest.approx(lens / (np.pi * DISC**2), abs=2e-3)
    angle = np.linspace(0, 2 * np.pi, 20000)
    # What lies further than 5 mm outside, to first order in the offset over the radius.
    spilt = np.maximum(offset * np.cos(angle) - 0.005, 0).mean() * 2 * np.pi * DISC
    assert found.excess == pytest.approx(spilt / wanted.area, rel=0.1, abs=1e-4)


def test_a_disc_painted_too_large_by_the_same_all_round(plane):
    wanted, grid = posed(drawing(([circle()], 0)), plane())
    found = score(wanted, grid, disc_film(grid, DISC + 0.012))
    assert found.stroke_error_mean == pytest.approx(0.012, abs=3e-4)
    assert found.stroke_error_p95 == pytest.approx(0.012, abs=5e-4)
    ring = (DISC + 0.012) ** 2 - (DISC + 0.005) ** 2
    assert found.excess == pytest.approx(ring / DISC**2, rel=0.02)


def test_a_hole_in_the_picture_has_a_boundary_and_gets_no_paint(plane):
    wanted, grid = posed(drawing(([circle(), circle(0.05)], 0)), plane())
    assert wanted.area == pytest.approx(np.pi * (DISC**2 - 0.05**2), rel=3e-3)
    assert wanted.layers[0].edge_length == pytest.approx(2 * np.pi * (DISC + 0.05), rel=2e-3)
    found = score(wanted, grid, disc_film(grid))
    assert found.coverage > 0.998
    assert found.excess == pytest.approx(0.045**2 / (DISC**2 - 0.05**2), rel=0.03)
    # Both ways: all of the paint's edge is right; from the hole's rim it is 0.1 m to any paint edge.
    assert found.stroke_error_mean == pytest.approx(0.5 * 0.1 * 0.05 / (DISC + 0.05), rel=0.03)


def test_bare_gaps_inside_are_coverage_alone(plane):
    wanted, grid = posed(drawing(([circle()], 0)), plane())
    film, uv = disc_film(grid), np.asarray(grid.centres(), float)
    slit = film * (np.abs(uv[..., 1]) > 0.003)  # from rim to rim
    enclosed = film * (np.linalg.norm(uv, axis=-1) > 0.04)
    whole = score(wanted, grid, film)
    for bare in (slit, enclosed):
        found = score(wanted, grid, bare)
        assert found.coverage < whole.coverage - 0.015
        assert found.stroke_error_mean < 4e-4
    half = score(wanted, grid, film * (uv[..., 0] < 0))
    assert half.stroke_error_mean > 0.02, "what is left out to the outside is no gap"


def test_two_colours_side_by_side(plane):
    left, right = box(-0.3, -0.2, 0.0, 0.2), box(0.0, -0.2, 0.3, 0.2)
    wanted, grid = posed(drawing(([left], 0), ([right], 1), colours=2), plane())
    uv = np.asarray(grid.centres(), float)
    films = np.stack([soft(_box_distance(uv, middle)) for middle in (-0.15, 0.15)])
    good = score(wanted, grid, films)
    assert good.coverage > 0.995
    assert good.excess == 0
    assert good.stroke_error_mean < 5e-4
    assert wanted.layers[0].edge_length == pytest.approx(1.4, rel=5e-3), "where they touch counts for both"
    swapped = score(wanted, grid, films[::-1])
    assert swapped.coverage < 0.01
    assert swapped.excess > 0.95
    both_by_one = score(wanted, grid, np.stack([films.sum(axis=0), 0 * films[0]]))
    assert both_by_one.coverage == pytest.approx(0.5, abs=0.01)
    assert np.isnan(both_by_one.stroke_error_mean), "one colour is nowhere"


def _box_distance(uv, middle):
    apart = np.abs(uv - [middle, 0.0]) - [0.15, 0.2]
    return np.linalg.norm(np.maximum(apart, 0), axis=-1) + np.minimum(apart.max(axis=-1), 0)


def test_too_few_films_are_an_error(plane):
    wanted, grid = posed(drawing(([circle()], 1), colours=2), plane())
    with pytest.raises(ValueError, match="1 colours found, allowed: 2"):
        score(wanted, grid, disc_film(grid))


def test_lines_and_areas_share_the_error_by_their_length(plane):
    line = [[-0.35, 0.25], [0.35, 0.25]]
    wanted, grid = posed(drawing(([circle()], 0), lines=[line]), plane())
    uv = np.asarray(grid.centres(), float)
    sweep = np.stack([np.linspace(-0.35, 0.35, 400), np.full(400, 0.256)], axis=-1)
    band = soft(np.maximum(np.abs(uv[..., 1] - 0.256) - RADIUS, np.abs(uv[..., 0]) - 0.36))
    rows = np.stack([np.tile([-0.1, 0.1], 20), np.repeat(np.linspace(-0.1, 0.1, 20), 2)], axis=-1)
    swept = np.concatenate([sweep, rows]), np.ones(440, bool)
    found = score(wanted, grid, disc_film(grid) + band, swept)
    edge = 2 * np.pi * DISC
    assert found.stroke_error_mean == pytest.approx(0.006 * 0.7 / (0.7 + edge), rel=0.15)
    assert found.coverage > 0.85
    only_fill = score(wanted, grid, disc_film(grid), (rows, np.ones(40, bool)))
    assert only_fill.stroke_error_mean > 0.02, "the line was left out"


def test_outlines_are_lines(plane):
    wanted, _ = posed(drawing(([circle()], 0)), plane(), outlines=True)
    assert wanted.area == pytest.approx(2 * np.pi * DISC * 2 * RADIUS, rel=5e-3)
    assert len(wanted.lines) == 1


def test_a_hole_in_the_wall_cuts_area_and_boundary(plane):
    picture = drawing(([box(0.0, -0.15, 0.35, 0.15)], 0))
    wanted, grid = posed(picture, plane(hole=0.2))  # none beyond u = 0.3 within 0.2 of v = 0
    assert wanted.area == pytest.approx(0.3 * 0.3, rel=0.01)
    assert wanted.layers[0].edge_tree.data[:, 0].max() < 0.3
    uv = np.asarray(grid.centres(), float)
    apart = np.abs(uv - [0.15, 0.0]) - [0.15, 0.15]
    short = soft(np.maximum(np.maximum(apart[..., 0], apart[..., 1]), uv[..., 0] - 0.292))
    found = score(wanted, grid, short)
    assert 0.95 < found.coverage < 0.98
    assert found.stroke_error_mean < 6e-4, "paint that ends a little before the rim is no fault of its edge"


def walled(plane, left, right):
    """A wall from u = `left` to `right`."""
    scene = plane()
    chart = type(scene.chart)(jnp.asarray([left, -1.0]), jnp.asarray([right, 1.0]), 0.0)
    return type(scene)(chart, 0.5)


def test_the_end_of_the_wall_is_a_rim_and_the_end_of_the_cells_is_none(plane):
    """The cells end at the wall's left end, in it; at their other sides the wall goes on."""
    wanted, _ = posed(drawing(([box(-0.395, -0.1, 0.1, 0.1)], 0)), walled(plane, -0.4, 2.0))
    assert wanted.ground.on_surface.all()
    (column,) = np.flatnonzero(np.diff(wanted.layers[0].paintable.all(axis=0)))
    assert wanted.layers[0].paintable[:, column + 1 :].all()
    assert not wanted.layers[0].paintable[:, : column + 1].any()
    ends = wanted.origin[0] + CELL * column
    assert ends == pytest.approx(-0.4 + RADIUS + 0.005, abs=2e-3)  # to a cell or two


def test_how_much_of_the_edge_is_judged_is_told(plane):
    """10 mm of the upper and the lower side and the whole left side lie too near to the wall's end."""
    picture = drawing(([box(-0.395, -0.1, 0.1, 0.1)], 0))
    near, grid = posed(picture, walled(plane, -0.4, 2.0))
    uv = np.asarray(grid.centres(), float)
    apart = np.abs(uv - [-0.1475, 0.0]) - [0.2475, 0.1]
    film = soft(np.maximum(apart[..., 0], apart[..., 1]))
    found, away = score(near, grid, film), score(posed(picture, plane())[0], grid, film)
    length = 2 * (0.495 + 0.2)
    assert found.stroke_error_judged == pytest.approx(1 - (0.2 + 2 * 0.010) / length, abs=4e-3)
    assert away.stroke_error_judged == 1
    lines, _ = posed(drawing(lines=[[[-0.39, 0.0], [0.2, 0.0]]]), walled(plane, -0.4, 2.0))
    assert lines.judged == 1


def test_what_stands_before_the_wall_cuts_the_area(plane):
    class Occluded(type(plane())):
        """Something stands before the wall where y < -0.05."""

        def raycast(self, origin, direction):
            hit = super().raycast(origin, direction)
            return type(hit)(hit.distance - 0.3 * (origin[1] < -0.05), hit.normal, hit.colour, hit.valid)

    scene = plane()
    wanted, _ = posed(drawing(([circle()], 0)), Occluded(scene.chart, 0.5))
    assert wanted.mask.any(axis=0).nonzero()[0].max() * 0.001 + wanted.origin[0] == pytest.approx(
        0.05, abs=2e-3
    )
    assert wanted.layers[0].edge_tree.data[:, 0].max() < 0.05


def test_area_on_a_column_is_that_of_its_arc():
    scene = cylinder()
    canvas = Canvas(jnp.asarray([-1.0, 0.0, 1.5]), jnp.asarray(0.0), jnp.asarray([1.6, 0.6]))
    wanted, grid = posed(drawing(([box(-0.75, -0.2, 0.75, 0.2)], 0)), scene, canvas)
    arc = 2 * 2.0 * np.arcsin(0.75 / 2.0)
    assert wanted.area == pytest.approx(arc * 0.4, rel=4e-3)
    apart = np.abs(np.asarray(grid.centres(), float) - [0.0, 1.5]) - [0.5 * arc, 0.2]
    found = score(wanted, grid, soft(apart.max(axis=-1)))
    assert found.coverage > 0.998
    assert found.stroke_error_mean < 3e-4


def test_area_over_a_corner_is_that_of_both_faces():
    scene = corner()
    canvas = Canvas(jnp.asarray([0.0, 0.0, 1.5]), jnp.asarray(0.0), jnp.asarray([0.8, 0.6]))
    wanted, grid = posed(drawing(([box(-0.2, -0.2, 0.3, 0.2)], 0)), scene, canvas)
    left, right = -0.2 * np.sqrt(2), 0.3 * np.sqrt(2)
    assert wanted.area == pytest.approx((right - left) * 0.4, rel=5e-3)
    uv = np.asarray(grid.centres(), float)
    apart = np.abs(uv - [0.5 * (left + right), 1.5]) - [0.5 * (right - left), 0.2]
    strip = 0.010 - np.abs(uv[..., 0])  # bare, along the fold
    found = score(wanted, grid, soft(np.maximum(apart.max(axis=-1), strip)))
    assert found.coverage == pytest.approx(1 - 0.02 / (right - left), abs=3e-3)
    assert found.stroke_error_mean < 6e-4, "the strip left out is cut from the boundary too"
