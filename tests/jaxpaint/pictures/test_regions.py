"""Fill rules, and ink over ink."""

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from jaxpaint.errors import InputError
from jaxpaint.pictures import regions
from jaxpaint.pictures.drawing import Area
from jaxpaint.pictures.regions import areas_of, filled, line_strings, region_of

STAR = np.array([[np.sin(4 * np.pi * k / 5), np.cos(4 * np.pi * k / 5)] for k in (0, 1, 2, 3, 4, 0)])


def box(low: float, high: float, clockwise: bool = False) -> np.ndarray:
    ring = np.array([[low, low], [high, low], [high, high], [low, high], [low, low]], float)
    return ring[::-1] if clockwise else ring


def test_a_star_has_a_middle_by_nonzero_only():
    middle = shapely.Point(0, 0)
    assert filled([STAR], "nonzero").contains(middle)
    assert not filled([STAR], "evenodd").contains(middle)


@pytest.mark.parametrize(
    ("inner", "nonzero", "evenodd"), [(box(1, 2), 9, 8), (box(1, 2, clockwise=True), 8, 8)]
)
def test_a_hole_is_one_by_its_direction_or_its_parity(inner, nonzero, evenodd):
    assert filled([box(0, 3), inner], "nonzero").area == pytest.approx(nonzero)
    assert filled([box(0, 3), inner], "evenodd").area == pytest.approx(evenodd)


@given(st.integers(0, 10_000))
def test_faces_agree_with_the_winding_number_of_points(seed):
    rng = np.random.default_rng(seed)
    ring = rng.uniform(0, 1, (8, 2))
    ring = np.concatenate([ring, ring[:1]])
    points = rng.uniform(0, 1, (200, 2))
    # The angle through which the outline turns about a point, which shares nothing with the code under test.
    spokes = ring[None] - points[:, None]
    angles = np.unwrap(np.arctan2(spokes[..., 1], spokes[..., 0]), axis=1)
    winding = np.rint((angles[:, -1] - angles[:, 0]) / (2 * np.pi)).astype(int)
    clear = shapely.distance(shapely.points(points), shapely.LineString(ring)) > 1e-6
    for rule, inside in (("nonzero", winding != 0), ("evenodd", winding % 2 == 1)):
        found = shapely.contains_xy(filled([ring], rule), points)
        assert (found == inside)[clear].all()


def test_there_and_back():
    region = shapely.box(0, 0, 5, 5).difference(shapely.box(1, 1, 2, 2)).union(shapely.box(7, 7, 8, 8))
    areas = list(areas_of(region, 3))
    assert sorted(len(area.rings) for area in areas) == [1, 2] and {area.colour for area in areas} == {3}
    assert shapely.unary_union([region_of(area) for area in areas]).equals(region)
    assert sum(len(line) for line in line_strings(region)) == 15


def test_rings_that_cross_are_read_by_parity():
    assert region_of(Area((box(0, 2), box(1, 3)))).area == pytest.approx(6)


def test_nothing_encloses_nothing():
    assert filled([], "nonzero").is_empty and filled([box(0, 1)[:3]], "nonzero").is_empty


def test_outlines_that_cross_without_end_are_refused(monkeypatch):
    monkeypatch.setattr(regions, "_MAX_WORK", 20)
    with pytest.raises(InputError, match="crosses itself into 6 pieces; allowed are simpler fills"):
        filled([STAR], "nonzero")
