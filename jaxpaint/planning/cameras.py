"""Camera poses worth a look: before each part of the operating area, squarely or from an angle."""

import dataclasses
import itertools
import math

import numpy as np
from jaxtyping import Bool, Float

from jaxpaint.planning.area import OperatingArea

# What is not the preferred view costs this part of a stop: a radian aside, a picture on its side, a metre.
# Only their order matters: all of them together stay below a stop, so that no view is ever bought with one.
_ANGLE_COST, _ROLL_COST, _DISTANCE_COST = 0.1, 0.05, 0.5
# Coming as near as this grid of look-at points is near enough to the best one [m].
_GRID = 0.2
# An outline bends by noise: looks a little beyond the evenly spread ones reach ends that these just miss [m].
_HAIR = 0.04


@dataclasses.dataclass(frozen=True)
class ViewSettings:
    """distance: of the camera from the wall [m], the one preferred, and others: allowed too. turns, pitches:
    directions of view beside the wall's normal [rad], upwards positive. rolls: of the picture about its
    middle [rad]. margin: seen around the canvas [m]. overlap: of neighbouring pictures, at least [m].
    incidence: largest angle between the surface's normal and the line of sight [rad]. depths: nearest and
    farthest surface that the camera measures well [m].
    """

    distance: float = 0.70
    others: tuple[float, ...] = (0.60, 0.73, 0.76)
    turns: tuple[float, ...] = (-0.4, 0.4)
    pitches: tuple[float, ...] = (-0.5, -0.25, 0.25, 0.5)
    rolls: tuple[float, ...] = (math.pi / 2,)
    margin: float = 0.06
    overlap: float = 0.06
    incidence: float = math.radians(60)
    depths: tuple[float, float] = (0.3, 1.0)


@dataclasses.dataclass(frozen=True)
class Cameras:
    """Poses in the map frame, OpenCV axes: place [m], rotation R_map_camera. square: upright, and looking
    squarely at the surface from no nearer than is preferred. cost: of what is not the preferred view, in
    parts of a stop.
    """

    place: Float[np.ndarray, "cameras 3"]
    rotation: Float[np.ndarray, "cameras 3 3"]
    square: Bool[np.ndarray, " cameras"]
    cost: Float[np.ndarray, " cameras"]

    def __getitem__(self, which) -> "Cameras":
        return Cameras(self.place[which], self.rotation[which], self.square[which], self.cost[which])

    def __len__(self) -> int:
        return len(self.place)


def camera_rotation(heading: float, pitch: float = 0.0, roll: float = 0.0) -> Float[np.ndarray, "3 3"]:
    """R_map_camera of one that looks along a heading, `pitch` above the level, turned by `roll` [rad]."""
    c, s, up, level = math.cos(heading), math.sin(heading), math.sin(pitch), math.cos(pitch)
    ahead = np.array([c * level, s * level, up])
    right = np.array([s, -c, 0.0])
    down = np.cross(ahead, right)
    turned = math.cos(roll) * right + math.sin(roll) * down
    return np.stack([turned, np.cross(ahead, turned), ahead], axis=1)


def camera_candidates(area: OperatingArea, field: tuple[float, float], s: ViewSettings) -> Cameras:
    """Cameras before the area at all distances, turned, pitched and rolled.

    field: width and height of the picture at distance 1 [m].
    """
    place, rotation, square, cost = [], [], [], []
    for kind in _kinds(s):
        distance, turn, pitch, roll = kind
        wide, high = (x * distance - s.overlap - area.spacing for x in (field if roll == 0 else field[::-1]))
        for way in _looks(area.arc, wide):
            point, normal = area.profile.at(way, wide / 2)
            R = camera_rotation(normal + turn, pitch, roll)
            for height in _looks(area.heights, high):
                place.append(np.array([*point, height]) - distance * R[:, 2])
                rotation.append(R)
                square.append(turn == pitch == roll == 0 and distance >= s.distance)
                cost.append(_cost(s, *kind))
    return Cameras(np.array(place), np.array(rotation), np.array(square), np.array(cost))


def _kinds(s: ViewSettings) -> list[tuple[float, float, float, float]]:
    """Distance, turn, pitch and roll; who looks from an angle has changed the distance already."""
    everything = itertools.product(
        (s.distance, *s.others), (0.0, *s.turns), (0.0, *s.pitches), (0.0, *s.rolls)
    )
    return [kind for kind in everything if kind[0] == s.distance or kind[1] == kind[2] == 0]


def _cost(s: ViewSettings, distance: float, turn: float, pitch: float, roll: float) -> float:
    angles = _ANGLE_COST * (abs(turn) + abs(pitch)) + _ROLL_COST * (roll != 0)
    return angles + _DISTANCE_COST * abs(distance - s.distance)


def _looks(ends: tuple[float, float], window: float) -> Float[np.ndarray, " n"]:
    """Where to look at along a length: the middles of 1, 2, ... windows spread evenly over it, and a grid."""
    low, high = ends
    length, middle = high - low, (high + low) / 2
    if length <= window:
        return middle + np.linspace(-0.5, 0.5, 5) * (window - length)
    most = 1 + math.ceil((length - window) / max(window, 1e-3) - 1e-9)
    half = (length - window) / 2
    evenly = [np.linspace(-h, h, n) for n in range(2, most + 2) for h in (half, half + _HAIR)]
    grid = np.linspace(-half, half, 1 + math.ceil(2 * half / _GRID))
    return middle + np.unique(np.concatenate([*evenly, grid]).round(3))
