"""Where the base may stand to look at an operating area, and how it gets from one such place to the next."""

import numpy as np
from jaxtyping import Float, Int

from jaxpaint.planning.area import OperatingArea
from jaxpaint.planning.reach import CameraArm
from jaxpaint.planning.surroundings import Surroundings, backed, drives_clear, stands_clear
from jaxpaint.planning.visits import shortest_order

# Stops are tried at this spacing along the wall, up to so far beyond its ends, and so far back [m]: steps
# well below the arm's reach, so that a view that is missed from one is had from the next.
_STEP, _BEYOND = 0.2, 0.4
_BACK = (0.0, 0.15, 0.3)
# The base faces the wall as a chord of this length lies [m]: about the base's own length, so that it does
# not turn into every niche.
_CHORD = 0.8
# A radian of turning takes as long as this way [m], and no detour is as bad as a blocked way.
_LEVER, _BLOCKED = 0.5, 100.0


def candidate_stops(
    area: OperatingArea, arm: CameraArm, around: Surroundings, clearance: float
) -> Float[np.ndarray, "stops 3"]:
    """Base poses that face the area from where the brush at home would touch it, or further back.

    Only those whose footprint stands clear of all that the lidar saw.
    """
    footprint = np.asarray(arm.footprint, float)
    low, high = area.arc[0] - _BEYOND, area.arc[1] + _BEYOND
    found = []
    for way in np.linspace(low, high, 1 + 2 * int(np.ceil((high - low) / 2 / _STEP))):
        for back in _BACK:
            away = facing_stop(area, way, arm, back)
            stop = backed(away, footprint, around.echoes, clearance)
            if stands_clear(stop, footprint, around.echoes, clearance):
                found.append(stop)
    return np.unique(np.array(found).reshape(-1, 3).round(6), axis=0)


def facing_stop(area: OperatingArea, way: float, arm: CameraArm, back: float = 0.0) -> Float[np.ndarray, "3"]:
    """The base pose that has the brush at home on the wall, `back` behind that [m]."""
    point, heading = area.profile.at(way, _CHORD)
    x, y = np.asarray(arm.brush, float)
    c, s = np.cos(heading), np.sin(heading)
    return np.array([point[0] - c * (x + back) + s * y, point[1] - s * (x + back) - c * y, heading])


def blocked_ways(
    stops: Float[np.ndarray, "n 3"], arm: CameraArm, around: Surroundings, clearance: float
) -> Int[np.ndarray, "blocked 2"]:
    """Pairs of stops with no clear straight way from one to the other."""
    footprint = np.asarray(arm.footprint, float)
    return np.array(
        [
            (i, j)
            for i in range(len(stops))
            for j in range(i + 1, len(stops))
            if not drives_clear(stops[i], stops[j], footprint, around.echoes, clearance)
        ],
        dtype=int,
    ).reshape(-1, 2)


def way_between(a: Float[np.ndarray, "*n 3"], b: Float[np.ndarray, "*n 3"]) -> Float[np.ndarray, "*n"]:
    """Length of a drive, turning counted in [m]."""
    return np.linalg.norm((a - b)[..., :2], axis=-1) + _LEVER * np.abs((a - b)[..., 2])


def order_stops(
    stops: Float[np.ndarray, "n 3"], blocked: Int[np.ndarray, "blocked 2"], end: Float[np.ndarray, "3"]
) -> tuple[Int[np.ndarray, " n"], bool]:
    """The shortest way through all stops and on to `end`, and whether no part of it is blocked."""
    between = way_between(stops[:, None], stops[None])
    for i, j in blocked:
        between[i, j] = between[j, i] = _BLOCKED
    order = shortest_order(between, np.zeros(len(stops)), way_between(stops, end))
    return order, bool((between[order[:-1], order[1:]] < _BLOCKED).all())
