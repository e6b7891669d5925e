"""Stops stand clear of a box before the wall, and the way round it is asked for."""

from types import SimpleNamespace

import numpy as np
import pytest

from jaxpaint.planning import operating_area, surroundings, wall_profile
from jaxpaint.planning.stops import blocked_ways, candidate_stops
from jaxpaint.planning.surroundings import stands_clear

CENTER, WIDTH, CLEARANCE = np.array([-0.05, 0.0, 1.1]), 3.6, 0.08
# The base is 0.8 m long, and the brush at home 0.9 m before its middle.
ARM = SimpleNamespace(
    footprint=np.array([[0.4, 0.3], [-0.4, 0.3], [-0.4, -0.3], [0.4, -0.3]]), brush=np.array([0.9, 0.0])
)
WALL = np.stack([np.zeros(201), np.linspace(-2, 2, 201)], axis=1)
# The front of a box: half a metre wide, a metre before the wall.
BOX = np.stack([np.full(26, -1.0), np.linspace(-1.05, -0.55, 26)], axis=1)


def _place(*seen):
    echoes = np.concatenate(seen)
    area = operating_area(wall_profile(CENTER, 0.0, WIDTH, echoes), WIDTH, (0.85, 1.35))
    return area, ARM, surroundings(echoes, CENTER, 0.0, WIDTH, 0.4), CLEARANCE


def _before_the_box(stops):
    return stops[np.abs(stops[:, 1] + 0.8) < 0.5]


def test_without_the_box_stops_stand_where_it_would_be():
    stops = candidate_stops(*_place(WALL))
    clear = [stands_clear(stop, ARM.footprint, BOX, CLEARANCE) for stop in stops]
    assert 0 < np.sum(clear) < len(clear)


def test_stops_are_moved_back_from_the_box_and_not_given_up():
    stops = candidate_stops(*_place(WALL, BOX))
    assert all(stands_clear(stop, ARM.footprint, np.concatenate([WALL, BOX]), CLEARANCE) for stop in stops)
    moved = _before_the_box(stops)
    assert len(moved) > 0
    assert moved[:, 0].max() == pytest.approx(-1.0 - 0.4 - CLEARANCE, abs=1e-3)


def test_what_stands_beside_the_base_gives_a_stop_up():
    # A post at the base's side, behind its front: driving straight back does not help soon enough.
    post = np.array([[-0.9, 0.33], [-1.05, 0.33], [-1.2, 0.33], [-1.3, 0.33]])
    stops = candidate_stops(*_place(WALL, post))
    assert all(stands_clear(stop, ARM.footprint, post, CLEARANCE) for stop in stops)
    assert len(stops) < len(candidate_stops(*_place(WALL)))


def test_a_way_through_the_box_is_blocked_and_one_past_it_is_not():
    stops = np.array([[-0.9, -1.6, 0.0], [-0.9, 0.0, 0.0], [-0.9, 1.0, 0.0]])
    np.testing.assert_array_equal(blocked_ways(stops, *_place(WALL, BOX)[1:]), [[0, 1], [0, 2]])
