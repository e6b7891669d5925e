"""Plane snapping: where a cloud is made of planes, its points go onto them."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from jaxpaint.refinement.checking import require_above
from jaxpaint.refinement.local_scales import NOISE_NEIGHBOURS, local_noise
from jaxpaint.refinement.neighbourhoods import Neighbourhoods
from jaxpaint.refinement.plane_search import find_planes, fit_plane, offsets
from jaxpaint.refinement.refined import Displacement

_ROUNDS = 2
_VOTERS = 32
_SUPPORT = 1 / 3
"""Share of a point's neighbours on a plane for it to belong there too: planes have no ends, faces do."""
_LEAST = 10


@dataclass(frozen=True)
class PlaneSnappingSettings:
    """When points belong to a plane.

    threshold: distance within which a point belongs to a plane, in units of the local noise [1]. share: least
    share of the cloud in a plane [1]. most: planes looked for. samples: triples tried for each. seed: of the
    samples. Of thresholds 3, 4 and 5 on simulated scans of walls, corners and boxes at 0.5 to 2.5 m, 3 gained
    less and 5 hardly more, which takes wider facets off what is curved; half the share and four times the
    samples gained nothing.
    """

    threshold: float = 4.0
    share: float = 0.02
    most: int = 12
    samples: int = 512
    seed: int = 0

    def __post_init__(self):
        require_above(0, threshold=self.threshold, share=self.share, most=self.most, samples=self.samples)


@dataclass(frozen=True)
class PlaneStatistics:
    """How much of the cloud planes are.

    displacement: of all points. explained: share of the points that belong to a plane [1]; where it is far
    below one the cloud is not made of planes, and the method does not apply. supports: points of each plane.
    """

    displacement: Displacement
    explained: float
    supports: tuple[int, ...]


@dataclass(frozen=True)
class Snapped:
    """A cloud with its points on planes, in the order and the type of the one that came.

    points: [m]. planes: unit normal n and offset d of each, n . p = d [m], n to the side of the viewpoint
    where one was given. plane_of: index of each point's plane; -1 where it has none and stays where it is.
    """

    points: Float[np.ndarray, "N 3"]
    planes: Float[np.ndarray, "P 4"]
    plane_of: Int[np.ndarray, "N"]
    statistics: PlaneStatistics


def snap_to_planes(
    points: Float[np.ndarray, "N 3"],
    settings: PlaneSnappingSettings = PlaneSnappingSettings(),
    *,
    viewpoint: Float[np.ndarray, "3"] | None = None,
) -> Snapped:
    """Each point that belongs to a plane moves to p - (n . p - d) n, on the nearest such plane; others stay.

    Planes by sequential RANSAC, then refitted to the points that they share out among them by total least
    squares with weights 1 / noise^2. Curved surfaces become facets as wide as the threshold lets them.
    Deterministic by the seed. viewpoint: [m]. Raises ValueError for what is no finite cloud of at least 10
    points.
    """
    near = Neighbourhoods.of(points, NOISE_NEIGHBOURS)
    cloud = near.points.astype(np.float64)
    limit = _limit(near, settings.threshold)
    planes = find_planes(
        cloud,
        limit,
        least=max(int(np.ceil(settings.share * len(limit))), _LEAST),
        most=settings.most,
        samples=settings.samples,
        seed=settings.seed,
    )
    plane_of = np.full(len(limit), -1)
    for _ in range(_ROUNDS if len(planes) else 0):
        plane_of = _owners(near, np.abs(offsets(planes, cloud)), limit)
        planes = np.stack([fit_plane(cloud, limit, plane_of == i, plane) for i, plane in enumerate(planes)])
    moved = _projected(cloud, planes, plane_of)
    supports = np.bincount(plane_of[plane_of >= 0], minlength=len(planes))
    statistics = PlaneStatistics(
        Displacement.between(near.points, moved), float((plane_of >= 0).mean()), tuple(supports.tolist())
    )
    return Snapped(near.placed(moved), _placed(planes, near.mean, viewpoint), plane_of, statistics)


def _limit(near: Neighbourhoods, threshold: float) -> Float[np.ndarray, "N"]:
    """Distance within which each point belongs to a plane [m]; above what rounding makes of a plane."""
    extent = float(np.abs(near.points).max())
    rounding = 16 * float(np.finfo(near.points.dtype).eps) * extent
    return np.maximum(threshold * local_noise(near).astype(np.float64), max(rounding, 1e-30))


def _owners(
    near: Neighbourhoods, distance: Float[np.ndarray, "P N"], limit: Float[np.ndarray, "N"]
) -> Int[np.ndarray, "N"]:
    """The nearest plane within the limit that enough neighbours are nearest to as well; -1 for none."""
    within = distance <= limit
    nearest = _nearest(distance, within)
    voters = near.nearest(_VOTERS)

    def votes(rows: slice) -> Float[np.ndarray, "P n"]:
        theirs = nearest[voters.index[rows]]
        return np.stack([(theirs == plane).mean(axis=1) for plane in range(len(distance))])

    return _nearest(distance, within & (voters.each(votes) >= _SUPPORT))


def _nearest(distance: Float[np.ndarray, "P N"], allowed: Bool[np.ndarray, "P N"]) -> Int[np.ndarray, "N"]:
    return np.where(allowed.any(axis=0), np.where(allowed, distance, np.inf).argmin(axis=0), -1)


def _projected(cloud, planes, plane_of):
    moved = cloud.copy()
    for index, plane in enumerate(planes):
        own = plane_of == index
        moved[:, own] -= plane[:3, None] * offsets(plane[None], cloud[:, own])
    return moved


def _placed(planes, mean, viewpoint):
    """Planes of the cloud about its mean as planes of the cloud as it came."""
    placed = np.column_stack([planes[:, :3], planes[:, 3] + planes[:, :3] @ mean])
    if viewpoint is None:
        return placed
    facing = placed[:, :3] @ np.asarray(viewpoint) >= placed[:, 3]
    return np.where(facing[:, None], placed, -placed)
