"""The wall's outline behind a canvas, from what the base's lidar saw of it before the scan."""

import dataclasses

import numpy as np
from jaxtyping import Float

# Bins across the canvas, and depths behind it at which an echo is taken for the wall [m].
_BINS = 25
_DEPTHS = (0.0, 1.3)
# Depth where the lidar saw nothing: a canvas is posed just in front of its wall [m].
_USUAL = 0.05


@dataclasses.dataclass(frozen=True)
class Profile:
    """The wall's outline at the height of the canvas: (x, y) in the map frame, from left to right [m]."""

    points: Float[np.ndarray, "n 2"]

    @property
    def arc(self) -> Float[np.ndarray, " n"]:
        """Way along the outline from its first point [m]."""
        return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(self.points, axis=0), axis=1))])

    @property
    def length(self) -> float:
        """Length of the outline [m]."""
        return float(self.arc[-1])

    def at(self, way: float, window: float) -> tuple[Float[np.ndarray, "2"], float]:
        """The point at `way` (beyond the ends along the last direction), and the heading into the wall there
        [rad].

        The heading is that of the chord over `window` [m], so that neither noise nor an edge turns it.
        """
        ahead, behind = self._point(way + window / 2), self._point(way - window / 2)
        along = ahead - behind
        return self._point(way), float(np.arctan2(along[0], -along[1]))

    def _point(self, way: float) -> Float[np.ndarray, "2"]:
        arc = self.arc
        inside = np.clip(way, 0.0, arc[-1])
        point = np.array([np.interp(inside, arc, self.points[:, axis]) for axis in (0, 1)])
        end = self.points[-1] - self.points[-2] if way > 0 else self.points[1] - self.points[0]
        return point + (way - inside) * end / np.linalg.norm(end)


def wall_profile(
    center: Float[np.ndarray, "3"], yaw: float, width: float, echoes: Float[np.ndarray, "beams 2"]
) -> Profile:
    """The outline behind a canvas of `width` [m] at `center`, with rays along `yaw`.

    echoes: lidar echoes (x, y) in the map frame, NaN for none. Each bin across the canvas takes the median
    depth of its echoes; clutter before the canvas is not the wall. Bins without echoes take their
    neighbours'.
    """
    ray = np.array([np.cos(yaw), np.sin(yaw)])
    right = np.array([np.sin(yaw), -np.cos(yaw)])
    offset = echoes[np.isfinite(echoes).all(-1)] - center[:2]
    across, depth = offset @ right, offset @ ray
    real = (depth >= _DEPTHS[0]) & (depth <= _DEPTHS[1])
    middles = (np.arange(_BINS) + 0.5) / _BINS * width - width / 2
    number = np.floor((across + width / 2) / width * _BINS)
    found = [depth[real & (number == i)] for i in range(_BINS)]
    known = np.array([len(f) > 0 for f in found])
    if not known.any():
        depths = np.full(_BINS, _USUAL)
    else:
        medians = np.array([np.median(f) if len(f) else np.nan for f in found])
        depths = np.interp(middles, middles[known], medians[known])
    return Profile(center[:2] + middles[:, None] * right + depths[:, None] * ray)
