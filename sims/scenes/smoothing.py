"""Local quadratic surfaces through gridded depths, at one width of window, edges kept.

Every cell gets the least-squares quadratic of its own region under a Gaussian window. The sums of that fit
are separable convolutions, so a window of any width costs the same handful of passes over the grid.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Bool, Float, Int
from scipy import ndimage

from sims.scenes.gridding import FrontSurface

_POWERS = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)]
_SCALES = np.array([1.0, 1.0, 1.0, 0.5, 1.0, 0.5])
# Slopes and curvatures that few cells support are drawn to zero, rather than extrapolated wildly.
_RIDGE = np.array([0.0, 1e-3, 1e-3, 2e-2, 2e-2, 2e-2])
_TUKEY = 4.7
_ACCEPTED, _REFUSED = 1.25, 1.5


@dataclass(frozen=True)
class Sheet:
    """One fit: depth [m], and how full the window was (1: all of it, on data)."""

    depth: Float[np.ndarray, "V U"]
    support: Float[np.ndarray, "V U"]


def fit_sheet(
    depth: Float[np.ndarray, "V U"],
    weight: Float[np.ndarray, "V U"],
    wanted: Bool[np.ndarray, "V U"],
    cell: float,
    width: float,
    noise: float,
    rounds: int = 3,
    degree: int = 2,
) -> Sheet:
    """Robust quadratics at the `wanted` cells through cells of positive weight; planes where degree is 1.

    width: standard deviation of the Gaussian window [m]. noise: spread of the data [m]; Tukey's weights fall
    to zero at 4.7 times that, `rounds` times over.
    """
    kernels = [_kernel(width / cell, power) for power in range(5)]
    known = np.where(weight > 0, depth, 0.0)
    weights = weight.copy()
    sheet = _solve(known, weights, wanted | (weight > 0), kernels, width, degree)
    for _ in range(rounds - 1):
        ratio = (known - sheet.depth) / (_TUKEY * noise)
        weights = weight * np.clip(1 - ratio**2, 0, 1) ** 2
        sheet = _solve(known, weights, wanted | (weight > 0), kernels, width, degree)
    return sheet


def _kernel(width: float, power: int) -> np.ndarray:
    """x^power under a Gaussian, x in units of its width; the coordinate of the neighbour from the centre."""
    reach = max(1, int(np.ceil(2.5 * width)))
    x = np.arange(-reach, reach + 1) / width
    gauss = np.exp(-0.5 * x**2)
    return (gauss / gauss.sum() * x**power).astype(np.float32)


def _solve(
    known: np.ndarray,
    weights: np.ndarray,
    cells: np.ndarray,
    kernels: list[np.ndarray],
    width: float,
    degree: int,
) -> Sheet:
    def moments(image: np.ndarray, powers: list[tuple[int, int]]) -> dict[tuple[int, int], np.ndarray]:
        # float32 is ample: the sums are of order one, and the data are known to a tenth of a millimetre.
        image = image.astype(np.float32)
        return {
            (p, q): cv2.sepFilter2D(image, -1, kernels[p], kernels[q], borderType=cv2.BORDER_CONSTANT)[cells]
            for p, q in powers
        }

    powers = _POWERS if degree == 2 else _POWERS[:3]
    sums = sorted({(p + r, q + s) for p, q in powers for r, s in powers})
    mass, load = moments(weights, sums), moments(weights * known, powers)
    matrix = np.empty((int(cells.sum()), len(powers), len(powers)))
    for i, (p, q) in enumerate(powers):
        for j, (r, s) in enumerate(powers):
            matrix[:, i, j] = _SCALES[i] * _SCALES[j] * mass[(p + r, q + s)]
    right = np.stack([scale * load[power] for scale, power in zip(_SCALES, powers, strict=False)], axis=-1)
    total = np.maximum(mass[(0, 0)].astype(float), 1e-6 * weights.max(initial=1.0))
    matrix += total[:, None, None] * np.diag(_RIDGE[: len(powers)]) + 1e-9 * np.eye(len(powers))
    value = np.linalg.solve(matrix, right[..., None])[..., 0]
    full = np.median(weights[weights > 0]) if (weights > 0).any() else 1.0
    depth, support = np.zeros(known.shape), np.zeros(known.shape)
    depth[cells], support[cells] = value[:, 0], total / full
    return Sheet(depth, support)


def fit_regions(
    front: FrontSurface, reach: Int[np.ndarray, "V U"], cell: float, width: float, noise: float
) -> Float[np.ndarray, "V U"]:
    """Depth of every cell [m]: each region on its own, at the widest window that describes its points.

    reach: the region whose surface a cell shall have, borders continued; 0 elsewhere, where the depth is
    that of what was captured, else that of the wall's plane, 0. Windows halve from `width` down to 1.5
    cells; one is taken where its residual stays below 1.25 times the noise.
    """
    depth = np.where(front.count > 0, np.nan_to_num(front.depth), 0.0)
    widths = [width / 2**k for k in range(8) if width / 2**k >= 1.5 * cell] or [width]
    for label, window in enumerate(ndimage.find_objects(reach), start=1):
        if window is None:
            continue
        mine = reach[window] == label
        # A window as wide as the region itself already sees all of it.
        useful = [widths[-1], *(wide for wide in widths[:-1] if wide < 0.5 * max(mine.shape) * cell)]
        weight = np.where(front.region[window] == label, front.count[window], 0.0)
        known = np.nan_to_num(front.depth[window])
        depth[window][mine] = _widest_fit(known, weight, mine, cell, sorted(useful), noise)[mine]
    return depth


def _widest_fit(
    known: np.ndarray, weight: np.ndarray, wanted: np.ndarray, cell: float, widths: list[float], noise: float
) -> Float[np.ndarray, "V U"]:
    """Fits from the narrowest window to the widest; each change is spread over a window's width."""
    result = None
    for width in widths:
        sheet = fit_sheet(known, weight, wanted, cell, width, noise)
        if result is None:
            result = sheet.depth
            continue
        error = _local_rms(known - sheet.depth, weight, width / cell)
        share = np.clip((_REFUSED * noise - error) / ((_REFUSED - _ACCEPTED) * noise), 0.0, 1.0)
        share = _blur(share, wanted.astype(float), width / cell)
        result = share * sheet.depth + (1 - share) * result
    return np.zeros_like(known) if result is None else result


def _local_rms(residual: np.ndarray, weight: np.ndarray, width: float) -> np.ndarray:
    return np.sqrt(_blur(residual**2, weight, width))


def _blur(image: np.ndarray, weight: np.ndarray, width: float) -> np.ndarray:
    """Weighted Gaussian mean; 0 far from any weight."""
    total = ndimage.gaussian_filter(weight, width, mode="constant", truncate=2.5)
    blurred = ndimage.gaussian_filter(weight * image, width, mode="constant", truncate=2.5)
    return np.where(total > 1e-9, blurred / np.maximum(total, 1e-9), 0.0)
