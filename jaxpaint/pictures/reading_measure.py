"""Measures how much of the ink of line art was read as lines, without the code that reads them."""

from collections.abc import Sequence

import cv2
import numpy as np
from jaxtyping import Bool, Float
from scipy import ndimage

from jaxpaint.pictures.drawing import Polyline, polyline_length
from jaxpaint.pictures.reading import Reading
from jaxpaint.pictures.skeleton import half_width, sampled

_FEW = 5  # pixels: a smaller patch of ink is noise and not counted
_SLACK = 2.0  # pixels beyond half of the ink's width that still lie under a line
_STEP = 0.5  # pixels between the points of a line that are looked at
_SUBPIXEL = 4  # fractional bits of cv2's discs


def reading_of(
    ink: Bool[np.ndarray, "rows columns"],
    lines: Sequence[Polyline],
    blots: Bool[np.ndarray, "rows columns"] | None = None,
) -> Reading:
    """How well lines, as (x, y) in pixels with the middle of the first at 0, are those of ink.

    ink: before specks are left out. blots: what was read as areas. A pixel lies under a line if it is no
    further from a point of it than half of the ink's width there, and two pixels more.
    """
    counted = _without_few(ink)
    half = half_width(ink)
    points = np.concatenate([np.zeros((0, 2)), *(_dense(line) for line in lines)])
    under = np.zeros(ink.shape, np.uint8) if blots is None else blots.astype(np.uint8)
    radii = sampled(half, points) + _SLACK
    for (x, y), radius in zip(_fixed(points), _fixed(radii), strict=True):
        cv2.circle(under, (int(x), int(y)), int(radius), 1, -1, shift=_SUBPIXEL)
    length = [polyline_length(line) for line in lines]
    on_ink = [
        one * float((sampled(half, _dense(line)) > 0).mean()) for one, line in zip(length, lines, strict=True)
    ]
    return Reading(int(counted.sum()), int((counted & (under > 0)).sum()), sum(length), sum(on_ink))


def _dense(line: Polyline) -> Float[np.ndarray, "points 2"]:
    """Points along a line, half a pixel apart at most."""
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    s = np.linspace(0, along[-1], int(np.ceil(along[-1] / _STEP)) + 1)
    return np.stack([np.interp(s, along, line[:, axis]) for axis in (0, 1)], axis=1)


def _fixed(values: np.ndarray) -> np.ndarray:
    return np.rint(values * 2**_SUBPIXEL).astype(int)


def _without_few(ink: Bool[np.ndarray, "rows columns"]) -> Bool[np.ndarray, "rows columns"]:
    label, count = ndimage.label(ink, structure=np.ones((3, 3)))
    few = np.bincount(label.ravel(), minlength=count + 1) < _FEW
    return ink & ~few[label]
