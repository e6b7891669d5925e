"""The operating area: the part of an upright surface that the camera has to see."""

import dataclasses

import numpy as np
from jaxtyping import Float

from jaxpaint.planning.profile import Profile

# Samples of an area: enough that footprints fit to a few centimetres, few enough for an exact set cover; and
# no finer than this [m], which is finer than any view is placed.
_SAMPLES = 450
_FINEST = 0.06
# A surface's direction is that of a chord of this length, so that the lidar's noise does not turn it [m].
_CHORD = 0.3


@dataclasses.dataclass(frozen=True)
class OperatingArea:
    """An upright surface between two heights, sampled.

    profile: the surface's outline. arc: its part that counts, way along the outline [m]. heights: of the
    lower and upper rim [m]. points, normals: samples in the map frame, normals level and out of the wall.
    spacing: of neighbouring samples, at most [m].
    """

    profile: Profile
    arc: tuple[float, float]
    heights: tuple[float, float]
    points: Float[np.ndarray, "n 3"]
    normals: Float[np.ndarray, "n 3"]
    spacing: float

    @property
    def size(self) -> tuple[float, float]:
        """Width along the outline and height [m]."""
        return self.arc[1] - self.arc[0], self.heights[1] - self.heights[0]


def operating_area(
    profile: Profile, width: float, heights: tuple[float, float], margin: float = 0.0, overlap: float = 0.0
) -> OperatingArea:
    """The surface behind a canvas of `width`, between its rims' `heights`, and `margin` around it [m].

    The outline may end short of the canvas' rims: it goes on straight. Footprints that overlap leave out a
    rim (see `footprints`), which is counted as margin.
    """
    margin = max(margin - (overlap + _FINEST) / 2, 0.0)
    across = float(np.linalg.norm(profile.points[-1] - profile.points[0]))
    beyond = max(width - across, 0.0) / 2 + margin
    arc = -beyond, profile.length + beyond
    rims = heights[0] - margin, heights[1] + margin
    span = np.array([arc[1] - arc[0], rims[1] - rims[0]])
    spacing = max(_FINEST, float(np.sqrt(span.prod() / _SAMPLES)))
    counts = np.ceil(span / spacing).astype(int) + 1
    ways, tall = (np.linspace(*ends, n) for ends, n in zip((arc, rims), counts, strict=True))
    places = [profile.at(way, _CHORD) for way in ways]
    floor = np.array([place for place, _ in places])
    out = np.array([[-np.cos(heading), -np.sin(heading), 0.0] for _, heading in places])
    points = np.concatenate([np.repeat(floor, len(tall), 0), np.tile(tall, len(ways))[:, None]], axis=1)
    return OperatingArea(profile, arc, rims, points, np.repeat(out, len(tall), 0), float(spacing))
