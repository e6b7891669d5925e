"""Where the camera looks from: S1 section II's waypoints C, few and covering the canvas with overlap."""

import dataclasses
import math

import numpy as np
from jaxtyping import Float


@dataclasses.dataclass(frozen=True)
class ViewpointSettings:
    """distance: of the camera from the canvas [m]. aside: how far left of the base's middle line the camera is
    held, since an arm cannot look straight ahead from above its own shoulder [m]. margin: covered around the
    canvas, for normals at its rim and for drift [m]. overlap: of neighbouring pictures [m]."""

    distance: float = 0.70
    aside: float = 0.25
    margin: float = 0.06
    overlap: float = 0.12


@dataclasses.dataclass(frozen=True)
class Viewpoints:
    """view: camera positions on the canvas (u, v) [m], `distance` before it and facing it. stop: (u) of the base
    at each view [m]; the base stands before the canvas and faces it. In the order of visiting."""

    view: Float[np.ndarray, "views 2"]
    stop: Float[np.ndarray, " views"]


def plan_viewpoints(
    size: tuple[float, float], field_of_view: tuple[float, float], settings: ViewpointSettings | None = None
) -> Viewpoints:
    """A grid of views that covers a canvas of `size` [m].

    field_of_view: width and height of the picture at distance 1 [m]. The base stops once for each column; columns
    are visited from right to left, so that the robot ends where a drawing begins, and each column up and down.
    """
    s = settings or ViewpointSettings()
    wide, high = (s.distance * x for x in field_of_view)
    width, height = (x + 2 * s.margin for x in size)
    if width <= wide - 2 * s.aside:
        views, stops = np.array([-s.aside]), np.array([0.0])
    else:
        views = _spread(width, wide, s.overlap)[::-1]
        stops = views + s.aside
    rows = _spread(height, high, s.overlap)
    order = [(i, j) for i in range(len(views)) for j in range(len(rows))[:: 1 if i % 2 == 0 else -1]]
    return Viewpoints(
        np.array([(views[i], rows[j]) for i, j in order]), np.array([stops[i] for i, _ in order])
    )


def _spread(length: float, window: float, overlap: float) -> Float[np.ndarray, " n"]:
    """Middles of the fewest windows that cover a length about 0 with overlap."""
    if length <= window:
        return np.zeros(1)
    count = max(2, 1 + math.ceil((length - window) / max(window - overlap, 1e-3) - 1e-9))
    return np.linspace(-(length - window) / 2, (length - window) / 2, count)
