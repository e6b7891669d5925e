"""The base's rectangle among posts: signed distances, and what lies between two moments."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import shapely

from jaxpaint.trajectories import Obstacles, footprint_gap

CORNERS = np.array([[0.4, 0.3], [-0.3, 0.3], [-0.3, -0.3], [0.4, -0.3]])
GAP = jax.jit(lambda base, there: footprint_gap(jnp.asarray(CORNERS), base, there, jnp.asarray(0.46)))


def posts(*places):
    return Obstacles.sticks(jnp.array(places), jnp.full(len(places), 1.0))


@pytest.mark.parametrize("seed", range(6))
def test_the_distance_of_one_place_is_that_of_the_polygon(seed):
    rng = np.random.default_rng(seed)
    x, y, yaw = rng.uniform(-1, 1, 3) * [1, 1, 3]
    place = np.array([x, y]) + rng.uniform(-0.7, 0.7, 2)
    c, s = np.cos(yaw), np.sin(yaw)
    shape = shapely.Polygon(CORNERS @ [[c, s], [-s, c]] + [x, y])
    point = shapely.Point(place)
    wanted = -shape.exterior.distance(point) if shape.contains(point) else shape.distance(point)
    assert float(GAP(jnp.array([[x, y, yaw]]), posts(place))) == pytest.approx(wanted, abs=1e-5)


def test_the_nearest_counts_and_what_is_none_or_begins_above_does_not():
    there = posts([2.4, 0.0], [1.4, 0.1], [np.nan, 0.0])
    high = Obstacles.points(jnp.array([[0.0, 0.0, 0.9], [np.nan, 0, 0]]))
    assert float(GAP(jnp.zeros((1, 3)), there + high)) == pytest.approx(1.0, abs=1e-5)
    low = Obstacles.points(jnp.array([[0.0, 0.0, 0.2], [np.nan, 0, 0]]))
    assert float(GAP(jnp.zeros((1, 3)), there + low)) == pytest.approx(-0.3, abs=1e-5)


def test_a_post_that_is_passed_between_two_moments_is_seen_and_one_beside_the_way_is_not_taken_for_it():
    """The ends alone are half a metre clear of the post in the middle."""
    ends = jnp.array([[-1.0, 0, 0], [1.0, 0, 0]])
    way = jnp.linspace(ends[0], ends[1], 64)
    assert float(GAP(ends[:1], posts([0.1, 0.0]))) > 0.5 and float(GAP(ends, posts([0.1, 0.0]))) < 0
    assert float(GAP(way, posts([0.1, 0.0]))) == pytest.approx(-0.3, abs=0.03)
    assert float(GAP(way, posts([0.1, 0.6]))) == pytest.approx(0.3, abs=0.03)
