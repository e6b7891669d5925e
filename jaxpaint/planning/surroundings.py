"""What the lidar knows of the place: echoes that stand for walls, and clutter before the canvas."""

import dataclasses

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float
from scipy.spatial import KDTree

# Clutter may be this much higher than the beams that met it [m]: a guess, as nothing measures it. With the
# reference robot's lidar that is 0.71 m, below the default canvas; what is higher would hide some of it.
CLUTTER = 0.25
# Echoes this far before the canvas are clutter and not the wall: five times the lidar's noise [m].
_BEFORE = 0.05
# And up to this far beside it [m]: half a base's width, as what stands there is in the way of one who paints.
_BESIDE = 0.3
# Points this far behind an echo are of something else [m]: a slanted wall's, as far aside as counts, are not.
_FURTHER_BACK = 0.12
# Points this far aside of an echo lie in its direction [m]: as far apart as scanned points are.
_SAME_WAY = 0.05
# Steps of a drive at which its way is looked at [m], shorter than what hides between them; a turn counts with
# the length of the footprint.
_STEP = 0.05


# Rows of NumPy for planning on the host, of JAX inside of compiled programs.
Xs = np.ndarray | Array


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
    """Sorts the lidar's echoes (NaN for none) into clutter and walls, by `is_clutter`.

    center, yaw, width: the canvas' middle [m], heading of its rays [rad] and width [m]. lidar: height of the
    beams [m].
    """
    known = echoes[np.isfinite(echoes).all(-1)]
    low = is_clutter(known, center[:2], np.array([np.cos(yaw), np.sin(yaw)]), width)
    return Surroundings(known[~low], known[low], lidar + CLUTTER)


def is_clutter(
    echoes: Float[Xs, "beams 2"],
    center: Float[Xs, "2"],
    ray: Float[Xs, "2"],
    width: Float[Xs, ""] | float,
) -> Bool[Xs, " beams"]:
    """Which of the lidar's echoes are low: what stands before a canvas is clutter, all else a wall.

    center: of the canvas, ray: its rays' level unit direction, width: its own [m]; all NumPy or all JAX. A
    planar lidar knows no heights. A wall, at all heights, is the safe guess except where the wall is known
    to be further back. An echo that is NaN is no clutter.
    """
    offset = echoes - center
    depth, across = offset @ ray, offset[:, 0] * ray[1] - offset[:, 1] * ray[0]
    return (depth < -_BEFORE) & (abs(across) < width / 2 + _BESIDE)


def seen_over(
    echoes: Float[Array, "beams 2"], points: Float[Array, "m 3"], ray: Float[Array, "2"]
) -> Float[Array, " beams"]:
    """Lowest height [m] at which the camera saw something behind each echo; infinite where it saw nothing.

    What the lidar met has ended below that, or is among the points itself. points: scanned, NaN for none.
    ray: level unit direction in which the wall is looked at. All in the map frame, of JAX.
    """
    aside = jnp.array([ray[1], -ray[0]])
    beside = jnp.abs((points[:, :2] @ aside)[None] - (echoes @ aside)[:, None]) < _SAME_WAY
    behind = (points[:, :2] @ ray)[None] - (echoes @ ray)[:, None] > _FURTHER_BACK
    return jnp.where(beside & behind, points[None, :, 2], jnp.inf).min(axis=1)


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
