"""Few colours out of many, compared as people see them (CIE Lab)."""

from collections.abc import Sequence

import cv2
import numpy as np
from jaxtyping import Float, Int
from scipy.cluster.hierarchy import fcluster, linkage

from jaxpaint.pictures.drawing import Colour

MOST = 8
"""Colours of a drawing at most: each is a pass with its own tool."""
NEAR = 12.0
"""Colours nearer than this in Lab are painted as one."""
SAME = 4.0
"""Colours nearer than this to the paper's are not painted."""


def lab(rgb: Float[np.ndarray, "*n 3"]) -> Float[np.ndarray, "*n 3"]:
    """CIE Lab (L from 0 to 100) of sRGB from 0 to 1."""
    rows = np.ascontiguousarray(np.asarray(rgb, np.float32).reshape(1, -1, 3))
    return cv2.cvtColor(rows, cv2.COLOR_RGB2Lab).reshape(np.shape(rgb))


def alike(a: Colour, b: Colour, within: float = SAME) -> bool:
    """Whether two colours differ by less than a distance in Lab."""
    return bool(np.linalg.norm(lab(np.array(a)) - lab(np.array(b))) < within)


def merged(
    colours: Sequence[Colour], weights: Sequence[float], *, near: float = NEAR, most: int = MOST
) -> tuple[tuple[Colour, ...], Int[np.ndarray, " colours"]]:
    """A palette for colours, lightest first, and the place in it of each of them.

    Groups whose means are nearer than `near` become one, and so do the nearest ones while there are more than
    `most`; a group has the colour of its heaviest member, so that a colour of the picture is kept.
    """
    distinct, member = np.unique(np.round(np.array(colours) * 63), axis=0, return_inverse=True)
    group = _groups(distinct / 63, near)
    if group.max() >= most:
        group = fcluster(linkage(lab(distinct / 63), "average"), most, "maxclust") - 1
    place = group[member.ravel()]
    weight = np.array(weights)
    heaviest = [int(np.where(place == k, weight, -1.0).argmax()) for k in range(place.max() + 1)]
    palette = np.array([colours[i] for i in heaviest])
    order = np.argsort(-lab(palette)[:, 0], kind="stable")
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    return tuple((float(r), float(g), float(b)) for r, g, b in palette[order]), rank[place]


def too_many(colours: Sequence[Colour], *, near: float = NEAR, most: int = MOST) -> int:
    """How many colours lose their own place in a palette because there are more than `most`."""
    distinct = np.unique(np.round(np.array(colours) * 63), axis=0)
    return max(0, int(_groups(distinct / 63, near).max()) + 1 - most)


def _groups(distinct: Float[np.ndarray, "n 3"], near: float) -> Int[np.ndarray, " n"]:
    """The group of each colour, from 0: those whose means are nearer than `near`."""
    if len(distinct) == 1:
        return np.zeros(1, dtype=int)
    return fcluster(linkage(lab(distinct), "average"), near, "distance") - 1
