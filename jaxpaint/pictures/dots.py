"""Dots of line art: ink too short to have a centre-line, which thinning leaves next to nothing of."""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Bool, Float
from scipy import ndimage

from jaxpaint.pictures.drawing import polyline_length
from jaxpaint.pictures.skeleton import CentreLine, half_width, sampled

EVEN = 1.6
"""Ink up to so many times as wide as lines usually are is a line: hands press a pen more here than there."""

_STUB = 2.0  # widths: a piece of ink that is shorter, tip to tip, is a dot


@dataclass(frozen=True, eq=False)
class Parted:
    """Line art as lines, dots as wide as those, and wider ones, the blots.

    dots: their middles (x, y) in pixels. blots: the pixels of all of them.
    """

    lines: list[CentreLine]
    dots: Float[np.ndarray, "dots 2"]
    blots: Bool[np.ndarray, "rows columns"]


def parted(ink: Bool[np.ndarray, "rows columns"], lines: list[CentreLine]) -> Parted:
    """Ink and its centre-lines, with the dots told apart, each a connected piece of ink."""
    label, count = ndimage.label(ink, structure=np.ones((3, 3)))
    piece = _piece_of(lines, label)
    half = half_width(ink) + 0.25  # pixels of a thin line's middle measure a little less than half of it
    along = np.bincount(piece, [polyline_length(line.points) for line in lines], minlength=count + 1)
    width = np.asarray(2 * ndimage.maximum(half, label, np.arange(count + 1)))
    # A centre-line ends half a width before the tips of its ink.
    is_dot = along < (_STUB - 1) * width
    is_dot[0] = False
    others = [line for line, k in zip(lines, piece, strict=True) if not is_dot[k]]
    is_blot = is_dot & (width > EVEN * _usual_width(half, others or lines))
    small = np.flatnonzero(is_dot & ~is_blot)
    middles = np.array(ndimage.center_of_mass(ink, label, small), float).reshape(-1, 2)[:, ::-1]
    return Parted(others, middles, is_blot[label])


def _usual_width(half: Float[np.ndarray, "rows columns"], lines: list[CentreLine]) -> float:
    return 2 * float(np.median(sampled(half, np.concatenate([line.points for line in lines]))))


def _piece_of(lines: list[CentreLine], label: np.ndarray) -> np.ndarray:
    """The piece of ink that each line is of: smoothing may have moved it just off its pixels."""
    near = np.where(
        label > 0, label, cv2.dilate(label.astype(np.float32), np.ones((5, 5))).astype(label.dtype)
    )
    at = np.array([np.rint(line.points[len(line.points) // 2]) for line in lines], int).reshape(-1, 2)
    columns, rows = np.clip(at, 0, np.array(label.shape)[::-1] - 1).T
    return near[rows, columns]
