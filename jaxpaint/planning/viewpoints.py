"""Where the camera looks from: S1 section II's waypoints C, few and covering the canvas with overlap."""

import dataclasses
import math

import numpy as np
from jaxtyping import Float

from jaxpaint.planning.profile import Profile

# More room than this share of the distance at which the robot paints is no advantage.
_ROOM = 0.9


@dataclasses.dataclass(frozen=True)
class ViewpointSettings:
    """distance: of the camera from the wall [m]. aside: how far beside the base's middle line the camera is
    held, since an arm cannot look straight ahead from above its own shoulder [m]. margin: covered around the
    canvas, for normals at its rim and for drift [m]. overlap: of neighbouring pictures [m]. clearance: of the
    base from anything on the floor [m].
    """

    distance: float = 0.70
    aside: float = 0.25
    margin: float = 0.06
    overlap: float = 0.12
    clearance: float = 0.08


@dataclasses.dataclass(frozen=True)
class Viewpoints:
    """camera: positions in the map frame [m], heading: of the upright cameras about z [rad], base: poses (x,
    y, yaw) from which they are reached. In the order of visiting; views from one base pose follow each other.
    """

    camera: Float[np.ndarray, "views 3"]
    heading: Float[np.ndarray, " views"]
    base: Float[np.ndarray, "views 3"]


def plan_viewpoints(
    profile: Profile,
    heights: tuple[float, float],
    field_of_view: tuple[float, float],
    home: tuple[float, float],
    footprint: Float[np.ndarray, "corners 2"],
    echoes: Float[np.ndarray, "beams 2"],
    settings: ViewpointSettings | None = None,
) -> Viewpoints:
    """A grid of views along the wall's outline that covers a canvas.

    heights: of the canvas' lower and upper rim [m]. field_of_view: width and height of the picture at
    distance 1 [m]. home: brush in the base frame at the arm's best posture (x, y) [m]: the base stands so
    that this lies on the wall, or further back where its footprint (corners in its own frame [m]) would touch
    an echo of the lidar (x, y) [m]. Columns are visited from right to left, so that the robot ends where a
    drawing begins, each column in turn up and down.
    """
    s = settings or ViewpointSettings()
    wide, high = (s.distance * x for x in field_of_view)
    length, tall = profile.length + 2 * s.margin, heights[1] - heights[0] + 2 * s.margin
    middle = profile.length / 2
    if length <= wide - 2 * s.aside:
        columns = [_column(profile, middle, -s.aside, wide, home, s)]
    else:
        places = _spread(length, wide, s.overlap)[::-1]
        columns = [_towards_middle(profile, middle, place, wide, home, s) for place in places]
    columns = [(camera, heading, _backed(base, footprint, echoes, s)) for camera, heading, base in columns]
    rows = sum(heights) / 2 + _spread(tall, high, s.overlap)
    order = [(i, j) for i in range(len(columns)) for j in range(len(rows))[:: 1 if i % 2 == 0 else -1]]
    return Viewpoints(
        camera=np.array([[*columns[i][0], rows[j]] for i, j in order]),
        heading=np.array([columns[i][1] for i, _ in order]),
        base=np.array([columns[i][2] for i, _ in order]),
    )


def _towards_middle(profile: Profile, middle: float, place: float, wide: float, home, s: ViewpointSettings):
    """A view that faces the wall at `place` from the middle [m], with the base on its roomier side.

    Where both sides have room, the base stands on the side of the middle: less to drive.
    """
    point, heading = profile.at(middle + place, wide / 2)
    bases = [_base_at(point + side * _right(heading), heading, home) for side in (s.aside, -s.aside)]
    center, _ = profile.at(middle, wide / 2)

    def rank(base):
        room = np.linalg.norm(profile.points - base[:2], axis=1).min()
        return min(room, _ROOM * home[0]), -np.linalg.norm(base[:2] - center)

    return point - s.distance * _ahead(heading), heading, max(bases, key=rank)


def _column(profile: Profile, middle: float, place: float, wide: float, home, s: ViewpointSettings):
    """A view beside the middle [m], with the base before the middle."""
    point, heading = profile.at(middle, wide / 2)
    camera = point + place * _right(heading) - s.distance * _ahead(heading)
    return camera, heading, _base_at(point, heading, home)


def _base_at(
    point: Float[np.ndarray, "2"], heading: float, home: tuple[float, float]
) -> Float[np.ndarray, "3"]:
    """The base pose that has its best brush place at a point of the wall."""
    place = point - home[0] * _ahead(heading) + home[1] * _right(heading)
    return np.array([*place, heading])


def _backed(base, footprint, echoes, s: ViewpointSettings) -> Float[np.ndarray, "3"]:
    """The base pose, moved straight back until nothing that the lidar saw is within its footprint's way."""
    offset = echoes[np.isfinite(echoes).all(-1)] - base[:2]
    across, ahead = offset @ _right(base[2]), offset @ _ahead(base[2])
    front, side = footprint[:, 0].max(), np.abs(footprint[:, 1]).max()
    beside = (np.abs(across) < side + s.clearance) & (ahead > 0)
    back = max(0.0, front + s.clearance - ahead[beside].min()) if beside.any() else 0.0
    return base - back * np.array([*_ahead(base[2]), 0.0])


def _ahead(heading: float) -> Float[np.ndarray, "2"]:
    return np.array([math.cos(heading), math.sin(heading)])


def _right(heading: float) -> Float[np.ndarray, "2"]:
    return np.array([math.sin(heading), -math.cos(heading)])


def _spread(length: float, window: float, overlap: float) -> Float[np.ndarray, " n"]:
    """Middles of the fewest windows that cover a length about 0 with overlap."""
    if length <= window:
        return np.zeros(1)
    count = max(2, 1 + math.ceil((length - window) / max(window - overlap, 1e-3) - 1e-9))
    return np.linspace(-(length - window) / 2, (length - window) / 2, count)
