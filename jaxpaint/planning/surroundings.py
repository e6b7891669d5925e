"""What the lidar knows of the place: echoes that stand for walls, and clutter before the canvas."""

import dataclasses

import numpy as np
from jaxtyping import Bool, Float
from scipy.spatial import KDTree

# Clutter may be this much higher than the beams that met it [m].
CLUTTER = 0.25
# Echoes this far before the canvas, and up to this far beside it, are clutter and not the wall [m].
_BEFORE, _BESIDE = 0.05, 0.3
# Steps of a drive at which its way is looked at [m]; a turn counts with the length of the footprint.
_STEP = 0.05


@dataclasses.dataclass(frozen=True)
class Surroundings:
    """walls: echoes (x, y) of what stands at all heights. clutter: of what ends at `top` [m]."""

    walls: Float[np.ndarray, "n 2"]
    clutter: Float[np.ndarray, "m 2"]
    top: float

    @property
    def echoes(self) -> Float[np.ndarray, "k 2"]:
        """All of them."""
        return np.concatenate([self.walls, self.clutter])

    def gap(self, points: Float[np.ndarray, "*n 3"]) -> Float[np.ndarray, "*n"]:
        """Distance of points from the nearest thing at their height [m]; infinite where there is none."""
        gap = _nearest(self.walls, points[..., :2])
        return np.where(
            points[..., 2] < self.top, np.minimum(gap, _nearest(self.clutter, points[..., :2])), gap
        )


def surroundings(
    echoes: Float[np.ndarray, "beams 2"],
    center: Float[np.ndarray, "3"],
    yaw: float,
    width: float,
    lidar: float,
) -> Surroundings:
    """Sorts the lidar's echoes (NaN for none): what stands before a canvas is clutter, all else walls.

    center, yaw, width: the canvas' middle [m], heading of its rays [rad] and width [m]. lidar: height of the
    beams [m]. A planar lidar knows no heights; a wall is the safe guess except where the wall is known to be
    further back.
    """
    known = echoes[np.isfinite(echoes).all(-1)]
    offset = known - center[:2]
    depth = offset @ np.array([np.cos(yaw), np.sin(yaw)])
    across = offset @ np.array([np.sin(yaw), -np.cos(yaw)])
    low = (depth < -_BEFORE) & (np.abs(across) < width / 2 + _BESIDE)
    return Surroundings(known[~low], known[low], lidar + CLUTTER)


def stands_clear(
    base: Float[np.ndarray, "3"],
    footprint: Float[np.ndarray, "corners 2"],
    echoes: Float[np.ndarray, "n 2"],
    clearance: float,
) -> Bool[np.ndarray, ""]:
    """Whether no echo is within `clearance` [m] of the base's rectangle at (x, y, yaw)."""
    local = _seen_from(base, echoes)
    low, high = footprint.min(0) - clearance, footprint.max(0) + clearance
    return ~((local > low) & (local < high)).all(-1).any()


def backed(
    base: Float[np.ndarray, "3"],
    footprint: Float[np.ndarray, "corners 2"],
    echoes: Float[np.ndarray, "n 2"],
    clearance: float,
) -> Float[np.ndarray, "3"]:
    """The base pose, moved straight back until nothing ahead is within its footprint's way."""
    local = _seen_from(base, echoes)
    front, side = footprint[:, 0].max(), np.abs(footprint[:, 1]).max()
    ahead = local[(np.abs(local[:, 1]) < side + clearance) & (local[:, 0] > 0), 0]
    back = max(0.0, front + clearance + 1e-6 - ahead.min()) if len(ahead) else 0.0
    return base - back * np.array([np.cos(base[2]), np.sin(base[2]), 0.0])


def drives_clear(
    start: Float[np.ndarray, "3"],
    end: Float[np.ndarray, "3"],
    footprint: Float[np.ndarray, "corners 2"],
    echoes: Float[np.ndarray, "n 2"],
    clearance: float,
) -> bool:
    """Whether the straight way from one base pose to another (x, y, yaw), turning evenly, is clear."""
    turn = abs(end[2] - start[2]) * np.abs(footprint).max()
    count = 2 + int((np.linalg.norm((end - start)[:2]) + turn) / _STEP)
    way = start + np.linspace(0, 1, count)[:, None] * (end - start)
    return all(stands_clear(base, footprint, echoes, clearance) for base in way)


def _seen_from(base: Float[np.ndarray, "3"], points: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "n 2"]:
    c, s = np.cos(base[2]), np.sin(base[2])
    return (points - base[:2]) @ np.array([[c, -s], [s, c]])


def _nearest(tree: Float[np.ndarray, "n 2"], places: Float[np.ndarray, "*m 2"]) -> Float[np.ndarray, "*m"]:
    if not len(tree):
        return np.full(places.shape[:-1], np.inf)
    return KDTree(tree).query(places)[0]
