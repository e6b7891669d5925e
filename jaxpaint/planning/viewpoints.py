"""Where the camera looks from: S1 section II's waypoints C, the fewest that cover the operating area."""

import dataclasses
import math

import numpy as np
from jaxtyping import Bool, Float, Int

from jaxpaint.planning.area import OperatingArea
from jaxpaint.planning.cameras import Cameras, ViewSettings, camera_candidates
from jaxpaint.planning.footprints import footprints
from jaxpaint.planning.reach import CameraArm, near_pairs, reach
from jaxpaint.planning.serving import Candidates, serve
from jaxpaint.planning.set_cover import linear_bound, set_cover
from jaxpaint.planning.stops import blocked_ways, candidate_stops, facing_stop, order_stops
from jaxpaint.planning.surroundings import Surroundings
from jaxpaint.planning.visits import shortest_order

# Bases tried for a square view, and for any, likely ones first: each pair costs an inverse kinematics, there
# are ten times as many of all views as of square ones, and more of them to choose from.
_BASES = 16, 8
# A view that sees less than this share of what the best one sees is not tried: with two of those in place of
# one, a cover has a view more than it needs.
_WORTH = 0.4
# A camera stays this far from everything [m]: what the base may stand off, see `reach`, and its own size.
_CAMERA_GAP = 0.15


@dataclasses.dataclass(frozen=True)
class Viewpoints:
    """Camera poses in the order of visiting; views from one base pose follow each other.

    camera: positions in the map frame [m], rotation: R_map_camera, OpenCV axes. base: poses (x, y, yaw) from
    which they are reached, joints: the arm's there [rad]. lower_bound: no choice of views whatever covers the
    whole area with fewer, see `lower_bound`. candidate_bound: no choice among the views that were considered
    covers with fewer what these can see, reached or not. coverage: share of the area that the chosen ones
    see, as planned; views of nothing else are left out.
    reachable: False where the arm reaches no view at all: then these are the views it would need. clear:
    whether the straight way between consecutive bases is free of what the lidar saw.
    """

    camera: Float[np.ndarray, "views 3"]
    rotation: Float[np.ndarray, "views 3 3"]
    base: Float[np.ndarray, "views 3"]
    joints: Float[np.ndarray, "views arm"]
    lower_bound: int
    candidate_bound: int
    coverage: float
    reachable: bool
    clear: bool

    def __len__(self) -> int:
        return len(self.camera)


def plan_viewpoints(
    area: OperatingArea,
    field: tuple[float, float],
    arm: CameraArm,
    around: Surroundings,
    settings: ViewSettings | None = None,
    *,
    clearance: float = 0.08,
) -> Viewpoints:
    """The fewest views that cover the area, from the fewest stops, on a short way that ends at its left.

    field: width and height of the picture at distance 1 [m]. clearance: of the base from anything [m]. Square
    views are tried first; all others where those are not as few as the candidates' bound. What no reachable
    view sees is left out and counted in `coverage`.
    """
    s = settings or ViewSettings()
    cameras = camera_candidates(area, field, s)
    cameras = cameras[around.gap(cameras.place) > _CAMERA_GAP]
    sees = footprints(cameras, area, field, around, s)
    cameras, sees = cameras[sees.any(1)], sees[sees.any(1)]
    bounds = lower_bound(area, field, s), candidate_bound(sees)
    stops = candidate_stops(area, arm, around, clearance)
    best = None
    for tried, most in zip((cameras.square, np.ones(len(cameras), bool)), _BASES, strict=True):
        found = _reached(arm, cameras[tried], sees[tried], stops, around, most)
        plan = _planned(found, area, arm, around, clearance, bounds) if len(found.camera) else None
        if plan is not None and (best is None or _better(plan, best)):
            best = plan
        if best is not None and best.coverage == 1 and len(best) <= best.candidate_bound:
            break
    return best or _out_of_reach(cameras, sees, area, arm, bounds)


def lower_bound(area: OperatingArea, field: tuple[float, float], s: ViewSettings) -> int:
    """No fewer views cover the whole area, wherever the camera is and looks: by area alone.

    The largest footprint is that of a square view from the greatest depth that the camera measures well, all
    of its picture. A flat surface that is seen at an angle has a nearer side, of which less is in the picture
    than the slant adds; one that bends to the camera or away from it is nearer too. What is to be covered is
    the area with the rim that footprints leave out, see `footprints`.
    """
    rim = s.overlap + area.spacing
    width, height = (x + rim for x in area.size)
    return math.ceil(width * height / (field[0] * field[1] * s.depths[1] ** 2) - 1e-9)


def candidate_bound(sees: Bool[np.ndarray, "cameras points"]) -> int:
    """No fewer of these views cover what they can see: the area over the largest of their footprints, and the
    linear programme.
    """
    if not sees.any():
        return 0
    by_area = math.ceil(sees.any(0).sum() / sees.sum(1).max() - 1e-9)
    return max(by_area, linear_bound(sees))


def _better(a: Viewpoints, b: Viewpoints) -> bool:
    return (-a.coverage, len(a)) < (-b.coverage, len(b))


def _reached(arm: CameraArm, cameras: Cameras, sees, stops, around: Surroundings, most: int) -> Candidates:
    """The pairs of camera and stop that the arm reaches, of up to `most` stops a camera."""
    worth = sees.sum(1) >= _WORTH * sees.sum(1).max(initial=0)
    cameras, sees = cameras[worth], sees[worth]
    if not len(stops):
        empty = np.zeros(0, int)
        return Candidates(cameras, sees, stops, empty, empty, np.zeros((0, arm.home.shape[0])))
    camera, stop = near_pairs(arm, cameras.place, stops, most)
    joints, good = reach(arm, cameras.place[camera], cameras.rotation[camera], stops[stop], around)
    return Candidates(cameras, sees, stops, camera[good], stop[good], joints[good])


def _planned(
    found: Candidates,
    area: OperatingArea,
    arm: CameraArm,
    around: Surroundings,
    clearance: float,
    bounds: tuple[int, int],
) -> Viewpoints:
    """The fewest of the reached views in the order of visiting."""
    views = serve(found, area, arm, around, clearance)
    used = np.unique(found.stop[views])
    blocked = blocked_ways(found.stops[used], arm, around, clearance)
    order, clear = order_stops(found.stops[used], blocked, facing_stop(area, area.arc[0], arm))
    pairs = _visits(found, views, used[order], np.asarray(arm.home, float))
    camera = found.camera[pairs]
    return Viewpoints(
        found.cameras.place[camera],
        found.cameras.rotation[camera],
        found.stops[found.stop[pairs]],
        found.joints[pairs],
        *bounds,
        float(found.sees[camera].any(0).mean()),
        True,
        clear,
    )


def _visits(found: Candidates, views, stops, home) -> Int[np.ndarray, " views"]:
    """The pairs in the order of the stops, and at each stop so that the arm moves little."""
    order, here = [], home
    for stop in stops:
        mine = views[found.stop[views] == stop]
        q = found.joints[mine]
        between = np.abs(q[:, None] - q[None]).max(-1)
        mine = mine[shortest_order(between, np.abs(q - here).max(-1), np.zeros(len(mine)))]
        order.extend(mine)
        here = found.joints[mine[-1]]
    return np.array(order, int)


def _out_of_reach(
    cameras: Cameras, sees, area: OperatingArea, arm: CameraArm, bounds: tuple[int, int]
) -> Viewpoints:
    """The views that would be needed, from the base pose before the area's middle."""
    chosen = set_cover(sees).chosen
    base = np.tile(facing_stop(area, sum(area.arc) / 2, arm), (len(chosen), 1))
    joints = np.tile(np.asarray(arm.home, float), (len(chosen), 1))
    return Viewpoints(
        cameras.place[chosen], cameras.rotation[chosen], base, joints, *bounds, 0.0, False, False
    )
