"""Filled areas: nothing left bare, nothing far outside, however they lie."""

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from shapely import affinity

from jaxpaint.errors import InputError
from jaxpaint.pictures import Drawing, FillSettings, RasterSettings, fit, outlined, plan_strokes, read_drawing
from jaxpaint.pictures.regions import areas_of, region_of

BLACK = ((0.0, 0.0, 0.0),)
few = settings(max_examples=8)


def blots(seed: int, count: int = 4, size: float = 0.12) -> Drawing:
    """Blots with holes, tails and corners, some of them joined."""
    rng = np.random.default_rng(seed)
    shapes = []
    for centre in rng.uniform(-size, size, (count, 2)):
        angles = np.sort(rng.uniform(0, 2 * np.pi, 7))
        rim = centre + rng.uniform(0.01, 0.08, (7, 1)) * np.stack([np.cos(angles), np.sin(angles)], axis=1)
        shapes.append(shapely.Polygon(rim).buffer(0))
        shapes.append(shapely.LineString(rim[:3]).buffer(rng.uniform(0.0005, 0.012)))
    region = shapely.unary_union(shapes).difference(shapely.Point(0.02, 0).buffer(0.015))
    return drawing_of(region)


def drawing_of(region) -> Drawing:
    return Drawing((), (), tuple(areas_of(region, 0, least=1e-6)), BLACK, "test")


@few
@given(st.integers(0, 10_000), st.sampled_from([0.004, 0.010]), st.sampled_from(["hatch", "contour"]))
def test_of_every_area_next_to_all_is_covered(wall, seed, radius, style):
    drawing = blots(seed)
    pixels = wall(drawing)
    paint = pixels.painted(plan_strokes(drawing, 0.005, radius=radius, fill=FillSettings(style)), radius)
    assert pixels.coverage(paint) >= 0.98
    assert (pixels.ink & paint).sum() >= 0.99 * pixels.ink.sum()


@few
@given(st.integers(0, 10_000), st.floats(0, np.pi), st.floats(0.7, 2.0))
def test_turned_and_scaled_areas_are_covered_alike(wall, seed, angle, scale):
    region = shapely.unary_union([region_of(area) for area in blots(seed, 2).areas])
    turned = affinity.scale(affinity.rotate(region, angle, use_radians=True), scale, scale)
    pixels = wall(drawing_of(turned))
    fill = FillSettings(angle=angle, bleed=0.001 * scale)
    strokes = plan_strokes(drawing_of(turned), 0.005, radius=0.006 * scale, fill=fill)
    assert pixels.coverage(pixels.painted(strokes, 0.006 * scale)) >= 0.98
    # As long as before, in its own scale: how pieces fall into columns is all that may change.
    before = plan_strokes(drawing_of(region), 0.005, radius=0.006, fill=FillSettings(angle=0.0, bleed=0.001))
    assert strokes.length == pytest.approx(before.length * scale, rel=0.15)


@few
@given(st.integers(0, 10_000), st.floats(0, 0.003))
def test_the_brush_stays_within_the_bleed_of_ink_wider_than_itself(wall, seed, bleed):
    radius = 0.008
    region = shapely.unary_union([region_of(area) for area in blots(seed).areas])
    wide = region.buffer(-radius).buffer(radius)
    drawing = drawing_of(wide)
    assume(drawing.areas)
    strokes = plan_strokes(drawing, 0.005, radius=radius, fill=FillSettings(bleed=bleed))
    pixels = wall(drawing)
    assert pixels.excess(pixels.painted(strokes, radius), margin=bleed + 0.0015) == 0


def test_excess_of_a_thin_line_is_what_the_brush_is_wider():
    line = drawing_of(shapely.box(0, 0, 0.3, 0.002))
    strokes = plan_strokes(line, 0.005, radius=0.010)
    assert strokes.count == 1
    np.testing.assert_allclose(strokes.points[:, 1], 0.001, atol=0.001)
    left, right = sorted(strokes.points[[0, -1], 0])
    # Its ends stop short, so that the brush's edge ends a bleed beyond the ink.
    assert left == pytest.approx(0.00875, abs=2e-3) and right == pytest.approx(0.3 - 0.00875, abs=2e-3)


def test_a_dot_smaller_than_the_brush_is_a_dab():
    strokes = plan_strokes(drawing_of(shapely.Point(0.1, 0.2).buffer(0.003)), 0.005, radius=0.010)
    assert strokes.count == 1 and strokes.length < 0.004
    np.testing.assert_allclose(strokes.points.mean(axis=0), [0.1, 0.2], atol=2e-3)


def test_rows_run_to_and_fro_without_lifting():
    """One column of the wall: the rim, and all rows in one stroke."""
    strokes = plan_strokes(drawing_of(shapely.box(0, 0, 0.3, 0.2)), 0.005, radius=0.010)
    assert strokes.count == 2
    assert strokes.length == pytest.approx(0.3 * 0.2 / 0.013, rel=0.25)


def test_more_overlap_takes_more_rows():
    square = drawing_of(shapely.box(0, 0, 0.3, 0.3))
    lengths = [plan_strokes(square, 0.005, fill=FillSettings(overlap=o)).length for o in (0.1, 0.3, 0.5)]
    assert lengths[0] * 1.1 < lengths[1] and lengths[1] * 1.1 < lengths[2]


@pytest.mark.parametrize("angle", [0.0, 0.5, np.pi / 2])
def test_rows_have_the_angle(angle):
    strokes = plan_strokes(drawing_of(shapely.Point(0, 0).buffer(0.2)), 0.005, fill=FillSettings(angle=angle))
    steps = np.concatenate([np.diff(line, axis=0) for line in strokes.lines])
    lengths = np.linalg.norm(steps, axis=1)
    along = np.abs(steps @ [np.cos(angle), np.sin(angle)]) > 0.999 * lengths
    assert lengths[along].sum() > 0.6 * lengths.sum()


def test_outlines_are_drawn_once():
    ring = np.array([[0.0, 0], [1, 0], [1, 1], [0, 0]])
    areas = tuple(areas_of(shapely.Polygon(ring).union(shapely.box(3, 3, 4, 4)), 0))
    drawing = Drawing((ring[:3],), (0,), areas, BLACK, "test")
    assert len(outlined(drawing).lines) == 3 and not outlined(drawing).areas
    whole = Drawing((ring,), (0,), areas, BLACK, "test")
    assert len(outlined(whole).lines) == 2
    strokes = plan_strokes(whole, 0.1, fill=FillSettings("outline"))
    assert strokes.length == pytest.approx(2 + np.sqrt(2) + 4)


@pytest.mark.realdata
@pytest.mark.parametrize(
    ("name", "radius", "least", "most"),
    [
        ("ski_horse.png", 0.010, 0.995, 0.01),
        ("ski_text.png", 0.004, 0.99, 0.01),  # areas of a few hundred pixels
        ("gnu.svg", 0.004, 0.995, 0.01),
        ("gnu.svg", 0.010, 0.995, 0.05),  # of lines thinner than the brush
        ("python.svg", 0.010, 0.995, 0.01),
        pytest.param("apple.svg", 0.010, 0.995, 0.01, marks=pytest.mark.slow),
        ("rust.svg", 0.010, 0.995, 0.01),
        pytest.param("rust.svg", 0.004, 0.995, 0.01, marks=pytest.mark.slow),
    ],
)
def test_real_pictures(wall, shared_data, name, radius, least, most):
    drawing = fit(read_drawing(shared_data / "images" / name, RasterSettings("area")), (1.2, 1.2))
    pixels = wall(drawing)
    paint = pixels.painted(plan_strokes(drawing, 0.005, radius=radius), radius)
    assert pixels.coverage(paint) >= least
    assert pixels.excess(paint) <= most


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"style": "dots"}, "fill: found 'dots'; allowed are hatch, contour, outline"),
        ({"overlap": 1.0}, "fill overlap: found 1.0; allowed"),
        ({"bleed": -0.001}, "fill bleed: found -0.001; allowed"),
        ({"angle": float("nan")}, "fill angle: found nan; allowed"),
    ],
)
def test_impossible_settings(options, message):
    with pytest.raises(InputError, match=message):
        plan_strokes(drawing_of(shapely.box(0, 0, 1, 1)), 0.01, fill=FillSettings(**options))
