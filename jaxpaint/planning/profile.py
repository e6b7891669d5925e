"""The wall's outline behind a canvas, from what the base's lidar saw of it before the scan."""

import dataclasses

import numpy as np
from jaxtyping import Float

# Width of a bin across the canvas: some echoes fall into each, and few bins at least, for a narrow canvas to
# have a direction. Depths behind it at which an echo is taken for the wall: a corner is up to 0.85 m deep
# [m].
_BIN, _FEWEST = 0.08, 4
_DEPTHS = (0.0, 1.3)
# Beyond its ends the outline goes on as its last part runs, of this length [m].
_END = 0.4
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
        if way == inside:
            return point
        tips = (arc[-1] - _END, arc[-1]) if way > 0 else (0.0, _END)
        end = np.subtract(*(self._point(np.clip(tip, 0.0, arc[-1])) for tip in tips[::-1]))
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
    bins = max(_FEWEST, round(width / _BIN))
    middles = (np.arange(bins) + 0.5) / bins * width - width / 2
    number = np.floor((across + width / 2) / width * bins)
    found = [depth[real & (number == i)] for i in range(bins)]
    known = np.array([len(f) > 0 for f in found])
    if not known.any():
        depths = np.full(bins, _USUAL)
    else:
        medians = np.array([np.median(f) if len(f) else np.nan for f in found])
        depths = np.interp(middles, middles[known], medians[known])
    return Profile(center[:2] + middles[:, None] * right + depths[:, None] * ray)
