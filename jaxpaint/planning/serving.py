"""From which few stops a fewest number of views is taken."""

import dataclasses
import itertools

import numpy as np
from jaxtyping import Bool, Float, Int

from jaxpaint.planning.area import OperatingArea
from jaxpaint.planning.cameras import Cameras
from jaxpaint.planning.reach import CameraArm
from jaxpaint.planning.set_cover import cheap_cover, set_cover
from jaxpaint.planning.stops import blocked_ways, facing_stop, way_between
from jaxpaint.planning.surroundings import Surroundings

# A radian of the arm away from home costs this part of a stop: it decides between views that are alike.
_OFF_HOME = 0.02
# Groups of up to so many stops are tried, as there are 230,000 of four of fifty, and so many groups of each
# size: each is a set cover.
_STOPS, _TRIES = 3, 5


@dataclasses.dataclass(frozen=True)
class Candidates:
    """Cameras, what they see, where the base may stand, and which pairs of the two were found to do.

    joints: of the arm at each pair [rad].
    """

    cameras: Cameras
    sees: Bool[np.ndarray, "cameras points"]
    stops: Float[np.ndarray, "stops 3"]
    camera: Int[np.ndarray, " pairs"]
    stop: Int[np.ndarray, " pairs"]
    joints: Float[np.ndarray, "pairs arm"]

    @property
    def usable(self) -> Bool[np.ndarray, "cameras points"]:
        """What the cameras see that are reached from somewhere."""
        seen = np.zeros_like(self.sees)
        seen[self.camera] = self.sees[self.camera]
        return seen


def serve(
    found: Candidates, area: OperatingArea, arm: CameraArm, around: Surroundings, clearance: float
) -> Int[np.ndarray, " views"]:
    """The fewest views of all that can be seen, as pairs of `found`, from few stops near to each other.

    Groups of one, two, three stops are tried, those between which the base can drive straight; where none of
    them does with the fewest views, the stops are the fewest for one choice of views.
    """
    usable = found.usable
    seen = usable.any(0)
    chosen = set_cover(usable).chosen
    cost = found.cameras.cost[found.camera] + _OFF_HOME * np.abs(found.joints - np.asarray(arm.home)).mean(1)
    for group in _groups(found, usable[:, seen], area, arm, around, clearance):
        pairs = _cheapest_pairs(found, cost, group)
        views = cheap_cover(usable[found.camera[pairs]][:, seen], cost[pairs], len(chosen))
        if views is not None:
            return pairs[views]
    return _fewest_stops(found, cost, chosen)


def _groups(
    found: Candidates, sees, area: OperatingArea, arm: CameraArm, around: Surroundings, clearance: float
):
    """Groups of stops from which everything is seen, small and close ones first."""
    stops = found.stops
    seen = np.zeros((len(stops), sees.shape[1]), bool)
    np.logical_or.at(seen, found.stop, sees[found.camera])
    used = np.flatnonzero(seen.any(1))
    off = np.linalg.norm((stops - facing_stop(area, sum(area.arc) / 2, arm))[:, :2], axis=1)
    for size in range(1, _STOPS + 1):
        groups = np.array(list(itertools.combinations(used, size)), int).reshape(-1, size)
        groups = groups[_all_seen(seen, groups)]
        apart = sum(
            (way_between(stops[a], stops[b]) for a, b in itertools.pairwise(groups.T)), np.zeros(len(groups))
        )
        order = np.argsort(apart + off[groups].mean(1), kind="stable")
        clear = (g for g in groups[order] if not len(blocked_ways(stops[g], arm, around, clearance)))
        yield from itertools.islice(clear, _TRIES)


def _all_seen(seen, groups) -> Bool[np.ndarray, " groups"]:
    """Which groups of stops see every point; by the points that few stops see first."""
    alive = np.ones(len(groups), bool)
    for point in np.argsort(seen.sum(0), kind="stable"):
        alive[alive] = seen[groups[alive], point].any(1)
    return alive


def _cheapest_pairs(found: Candidates, cost, group) -> Int[np.ndarray, " pairs"]:
    """For each camera that a group of stops reaches, its cheapest pair."""
    pairs = np.flatnonzero(np.isin(found.stop, group))
    pairs = pairs[np.argsort(cost[pairs], kind="stable")]
    return pairs[np.unique(found.camera[pairs], return_index=True)[1]]


def _fewest_stops(found: Candidates, cost, chosen) -> Int[np.ndarray, " views"]:
    """One pair for each chosen view, from the fewest stops that reach them all."""
    reaches = np.zeros((len(found.stops), len(chosen)), bool)
    for view, camera in enumerate(chosen):
        reaches[found.stop[found.camera == camera], view] = True
    pairs = np.flatnonzero(np.isin(found.stop, set_cover(reaches).chosen) & np.isin(found.camera, chosen))
    pairs = pairs[np.argsort(cost[pairs], kind="stable")]
    return pairs[np.unique(found.camera[pairs], return_index=True)[1]]
