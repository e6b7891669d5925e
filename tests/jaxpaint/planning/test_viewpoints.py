"""How many views there are at least, and the outline and the area that they are planned on."""

import dataclasses

import numpy as np
import pytest

from jaxpaint.planning import ViewSettings, camera_rotation, operating_area, surroundings, wall_profile
from jaxpaint.planning.cameras import Cameras, camera_candidates
from jaxpaint.planning.footprints import footprints
from jaxpaint.planning.viewpoints import candidate_bound, lower_bound

FIELD = (1.898, 1.109)
CENTER = np.array([-0.05, 0.0, 1.1])
NOTHING = np.full((1, 2), np.nan)
FREE = surroundings(NOTHING, CENTER, 0.0, 2.0, 0.4)


def straight(width):
    """The outline of a flat wall at x = 0."""
    return wall_profile(CENTER, 0.0, width, np.stack([np.zeros(800), np.linspace(-4, 4, 800)], 1))


def camera_at(*place, **angles):
    return Cameras(np.array([place]), camera_rotation(0.0, **angles)[None], np.array([True]), np.zeros(1))


def flat_area(width=1.0, height=1.0):
    return operating_area(straight(width), width, (1.1 - height / 2, 1.1 + height / 2))


def test_the_area_is_the_canvas_on_the_wall():
    area = flat_area(2.4, 0.6)
    assert area.size == pytest.approx((2.4, 0.6), abs=1e-9)
    np.testing.assert_allclose(area.points[:, 0], 0, atol=1e-12)
    np.testing.assert_allclose(area.normals, np.tile([-1.0, 0, 0], (len(area.points), 1)), atol=1e-12)
    assert np.ptp(area.points[:, 1]) == pytest.approx(2.4)
    gaps = np.diff(np.unique(area.points[:, 1].round(9)))
    assert gaps.max() <= area.spacing + 1e-9


def test_what_a_square_view_sees_is_its_picture_without_a_rim():
    area, s = flat_area(2.4, 1.2), ViewSettings()
    sees = footprints(camera_at(-0.7, 0.1, 1.1), area, FIELD, FREE, s)[0]
    rim = (s.overlap + area.spacing) / 2
    offset = np.abs(area.points - [0, 0.1, 1.1])
    inside = (offset[:, 1] <= 0.35 * FIELD[0] - rim) & (offset[:, 2] <= 0.35 * FIELD[1] - rim)
    np.testing.assert_array_equal(sees, inside)


def test_a_picture_on_its_side_is_taller_than_wide():
    area, s = flat_area(2.4, 1.6), ViewSettings()
    upright, turned = (
        area.points[footprints(camera_at(-0.7, 0, 1.1, roll=roll), area, FIELD, FREE, s)[0]]
        for roll in (0.0, np.pi / 2)
    )
    assert np.ptp(upright[:, 1]) == pytest.approx(np.ptp(turned[:, 2]), abs=0.1)
    assert np.ptp(turned[:, 1]) < 0.7 < 1.0 < np.ptp(turned[:, 2])


def test_grazing_and_far_surfaces_do_not_count():
    area, s = flat_area(2.4, 0.6), ViewSettings()
    slant = Cameras(np.array([[-0.3, 0, 1.1]]), camera_rotation(-1.2)[None], np.array([False]), np.zeros(1))
    seen = area.points[footprints(slant, area, FIELD, FREE, s)[0]]
    assert len(seen)
    assert np.abs(seen[:, 1]).max() <= 0.3 * np.tan(s.incidence)
    assert not footprints(camera_at(-1.1, 0, 1.1), area, FIELD, FREE, s).any()


def test_clutter_hides_what_is_behind_it_up_to_its_height():
    area, s = flat_area(1.0, 1.2), ViewSettings()
    around = surroundings(np.array([[-0.2, 0.0]]), CENTER, 0.0, 1.0, 0.4)
    free, kept = (footprints(camera_at(-0.7, 0, 0.8), area, FIELD, a, s)[0] for a in (FREE, around))
    hidden = area.points[free & ~kept]
    assert len(hidden)
    assert np.abs(hidden[:, 1]).max() < 0.1
    assert hidden[:, 2].max() < 0.7
    assert kept[np.abs(area.points - [0, 0, 0.9]).max(1) < 0.07].all()


def test_fewer_candidates_than_their_bound_never_do():
    """Every choice of one fewer is tried, up to pairs."""
    s = ViewSettings()
    for width, height, least in ((0.5, 0.5, 1), (2.4, 0.6, 2), (1.6, 1.2, 3), (2.4, 1.0, 3)):
        area = flat_area(width, height)
        sees = footprints(camera_candidates(area, FIELD, s), area, FIELD, FREE, s)
        assert sees.any(0).all()
        bound = candidate_bound(sees)
        assert bound >= least
        missed = np.unique(~sees, axis=0).astype(np.float32)
        assert all_miss(missed, min(bound - 1, 2))


def all_miss(missed, number):
    """Whether every choice of so many rows, up to two, misses a point that none of them has."""
    if number < 2:
        return missed.any(1).all() if number else missed.shape[1] > 0
    return (missed @ missed.T > 0).all()


def test_no_more_than_the_bound_where_columns_fill_the_width_exactly():
    """Two columns of the narrowest pictures, side by side, need no third: the bound sees that."""
    area, s = flat_area(2.3, 0.5), ViewSettings()
    sees = footprints(camera_candidates(area, FIELD, s), area, FIELD, FREE, s)
    assert candidate_bound(sees) == 2


def test_the_bound_over_all_views_is_the_area_over_the_largest_picture():
    """A picture from 1 m is 1.898 m x 1.109 m; pictures overlap by 60 mm and the samples' spacing."""
    for width, height, bound in ((0.5, 0.5, 1), (1.7, 0.9, 1), (2.0, 1.1, 2), (2.4, 1.0, 2), (4.0, 1.2, 3)):
        assert lower_bound(flat_area(width, height), FIELD, ViewSettings()) == bound


def test_no_view_from_anywhere_sees_more_than_the_bound_has_it():
    rng, count, cell = np.random.default_rng(1), 400, 0.03
    y, z = np.meshgrid(np.arange(-1.8, 1.8, cell), np.arange(-0.7, 2.9, cell))
    points = np.stack([0 * y.ravel(), y.ravel(), z.ravel()], axis=1)
    wall = dataclasses.replace(
        flat_area(), points=points, normals=np.tile([-1.0, 0, 0], (len(points), 1)), spacing=cell
    )
    whole = dataclasses.replace(ViewSettings(), overlap=-cell)  # all of the picture, no rim
    turn, pitch, roll = (rng.uniform(-limit, limit, count) for limit in (1.0, 1.0, np.pi))
    rotation = np.stack([camera_rotation(*angles) for angles in zip(turn, pitch, roll, strict=True)])
    place = np.array([0.0, 0.0, 1.1]) - rng.uniform(0.4, 1.1, (count, 1)) * rotation[:, :, 2]
    anywhere = Cameras(place, rotation, np.zeros(count, bool), np.zeros(count))
    seen = footprints(anywhere, wall, FIELD, FREE, whole).sum(1) * cell**2
    square = footprints(camera_at(-0.9999, 0.0, 1.1), wall, FIELD, FREE, whole).sum() * cell**2
    assert square == pytest.approx(FIELD[0] * FIELD[1], rel=0.03)
    assert 0.6 < seen.max() / (FIELD[0] * FIELD[1]) < 1


def test_cameras_look_where_they_are_told():
    up = camera_rotation(0.3, 0.2, 0.0)
    np.testing.assert_allclose(up.T @ up, np.eye(3), atol=1e-12)
    assert np.linalg.det(up) == pytest.approx(1)
    assert up[2, 2] == pytest.approx(np.sin(0.2))
    assert up[2, 1] < 0  # the picture's down is down
    np.testing.assert_allclose(camera_rotation(0.0)[:, 0], [0, -1, 0], atol=1e-12)


def test_the_outline_of_a_corner_is_as_long_as_its_faces():
    y = np.linspace(-1.5, 1.5, 600)
    profile = wall_profile(CENTER, 0.0, 1.697, np.stack([0.85 - np.abs(y), y], axis=1))
    assert profile.length == pytest.approx(1.697 * np.sqrt(2), rel=0.06)
    area = operating_area(profile, 1.697, (0.8, 1.4))
    assert area.size[0] == pytest.approx(2.4, abs=0.08)


def test_the_outline_of_a_small_canvas_is_not_turned_by_noise():
    rng = np.random.default_rng(0)
    y = np.linspace(-2, 2, 800)
    profile = wall_profile(CENTER, 0.0, 0.5, np.stack([rng.normal(0, 0.01, 800), y], axis=1))
    headings = [profile.at(way, 0.66)[1] for way in np.linspace(0, profile.length, 9)]
    assert np.abs(headings).max() < np.radians(3)
    assert profile.length < 0.47


def test_a_blind_lidar_means_a_wall_at_the_canvas():
    profile = wall_profile(CENTER, 0.0, 1.0, NOTHING)
    np.testing.assert_allclose(profile.points[:, 0], 0.0, atol=1e-9)
