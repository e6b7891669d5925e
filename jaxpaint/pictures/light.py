"""Uneven light: how bright the paper is at each pixel, under the ink too."""

import cv2
import numpy as np
from jaxtyping import Bool, Float
from scipy import ndimage
from scipy.optimize import linprog

_SIDE = 400  # pixels of the picture on which the light is found
_CELLS = 20  # along its longer side, that the surface is fitted to
_PAPER = 0.8  # share of the cells that the surface lies above; solid ink on less than that leaves it on paper
_WINDOW = 10  # parts of the longer side: the neighbourhood in which shadows are followed
_RARE = 0.005  # share of the pixels: the darkest, which are ink if anything is
_REACH = 1e-3  # of a neighbourhood: where less of it is bare paper, the surface alone counts

Picture = Float[np.ndarray, "rows columns"]


def paper_about(light: Picture) -> Picture:
    """How bright the paper is [as `light`, 0 to 100] under and about each pixel; ink is darker than paper.

    A smooth surface through the bright parts says what is solid ink, however wide. What is left is paper and
    fine lines: its median in each neighbourhood, which shadows follow and lines do not change, is the paper.
    """
    small = _reduced(light)
    surface = np.maximum(surface_through(small, _PAPER), 1.0)
    ratio = small / surface
    solid = ndimage.binary_dilation(ratio < np.sqrt(np.quantile(ratio, _RARE)), iterations=2)
    window = max(15, max(small.shape) // _WINDOW) | 1
    bare = np.where(solid, _spread(ratio, ~solid, window), ratio)
    median = cv2.medianBlur((np.clip(bare, 0, 1.5) * 170).astype(np.uint8), window).astype(np.float32) / 170
    paper = surface * cv2.GaussianBlur(median, (0, 0), window / 4)
    rows, columns = light.shape
    return np.maximum(cv2.resize(paper.astype(np.float32), (columns, rows)), 1.0)


def levelled(light: Picture) -> Picture:
    """A picture less the surface that half of it lies below, be its ink dark or bright; 400 pixels a side."""
    small = _reduced(light)
    return small - surface_through(small, 0.5)


def surface_through(light: Picture, share: float) -> Picture:
    """The quadratic surface that a share of a picture lies below: quantile regression over its cells."""
    rows, columns = light.shape
    cell = max(rows, columns) / _CELLS
    size = max(2, round(columns / cell)), max(2, round(rows / cell))
    cells = cv2.resize(light, size, interpolation=cv2.INTER_AREA)
    # min sum of share * over + (1 - share) * under, with terms @ surface + over - under = cells
    terms, each = _terms(*cells.shape), np.eye(cells.size)
    free = np.zeros(terms.shape[1])
    result = linprog(
        np.concatenate([free, np.full(cells.size, share), np.full(cells.size, 1 - share)]),
        A_eq=np.concatenate([terms, each, -each], axis=1),
        b_eq=cells.ravel(),
        bounds=[(None, None)] * len(free) + [(0, None)] * (2 * cells.size),
        method="highs",
    )
    return (_terms(rows, columns) @ result.x[: len(free)]).reshape(rows, columns)


def _terms(rows: int, columns: int) -> Float[np.ndarray, "pixels 6"]:
    v, u = np.meshgrid(*((np.arange(n) + 0.5) / n * 2 - 1 for n in (rows, columns)), indexing="ij")
    u, v = u.ravel(), v.ravel()
    return np.stack([np.ones_like(u), u, v, u * u, u * v, v * v], axis=1)


def _spread(ratio: Picture, bare: Bool[np.ndarray, "rows columns"], window: int) -> Picture:
    """The mean of bare paper near each pixel, 1 where none is near."""
    weight, value = (
        cv2.GaussianBlur(np.where(bare, of, 0).astype(np.float32), (0, 0), window / 2)
        for of in (np.ones_like(ratio), ratio)
    )
    return (value + _REACH) / (weight + _REACH)


def _reduced(light: Picture) -> Picture:
    rows, columns = light.shape
    scale = min(1.0, _SIDE / max(rows, columns))
    size = max(8, round(columns * scale)), max(8, round(rows * scale))
    return cv2.resize(light.astype(np.float32), size, interpolation=cv2.INTER_AREA)
