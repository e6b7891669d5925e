"""How far the depth image of a plane is from one, in disparity, and how alike neighbours err.

Inverse depth is linear in the pixel over a plane, however it is slanted, so nothing but the picture is
needed: neither the plane's place nor the camera's. Host numpy, for pictures that were taken.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

LAGS = np.array([1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 24])
"""Distances at which neighbours are compared [px]."""

_ROUNDS = 20
# In robust standard deviations: where the weight has fallen to a quarter, and where a pixel is left out.
_WIDTH, _OUTLIER = 3.0, 5.0


@dataclass(frozen=True, eq=False)
class PlaneResidual:
    """What is left of a patch's disparity without its plane.

    residual: [px], NaN where there is no depth or an outlier. slope: of the plane's disparity along u and v
    [px/px]. disparity: mean [px]. outliers: share of the pixels with a depth that were left out [1].
    """

    residual: Float[np.ndarray, "height width"]
    slope: Float[np.ndarray, "2"]
    disparity: float
    outliers: float

    @property
    def rms(self) -> float:
        """Root mean square of the residual [px]."""
        return float(np.sqrt(np.nanmean(self.residual**2)))


def plane_residual(depth: Float[np.ndarray, "height width"], focal_baseline: float) -> PlaneResidual:
    """The residual of depths [m] (0 or NaN where there is none) of one plane; focal_baseline in [px m].

    Disparity f b / z = a + b u + c v by least squares with Geman-McClure weights. ValueError for a patch with
    fewer than ten depths, or whose depths give no plane.
    """
    seen = np.isfinite(depth) & (depth > 0)
    v, u = np.nonzero(seen)
    u, v = u - 0.5 * depth.shape[1], v - 0.5 * depth.shape[0]
    terms = np.stack([np.ones(u.size), u, v], axis=1)
    if u.size < 10 or np.linalg.matrix_rank(terms) < 3:
        raise ValueError(
            f"depth: found {u.size} depths in a patch of {depth.shape}; allowed is a plane of 10"
        )
    disparity = focal_baseline / depth[seen]
    weight = np.ones(u.size)
    for _ in range(_ROUNDS):
        root = np.sqrt(weight)
        plane = np.linalg.lstsq(terms * root[:, None], disparity * root, rcond=None)[0]
        error = disparity - terms @ plane
        # The floor keeps 0 / 0 out where the plane is exact.
        scale = max(1.4826 * float(np.median(np.abs(error))), 1e-9 * focal_baseline)
        weight = (1 + (error / (_WIDTH * scale)) ** 2) ** -2
    kept = np.abs(error) <= _OUTLIER * scale
    residual = np.full(depth.shape, np.nan)
    residual[seen] = np.where(kept, error, np.nan)
    return PlaneResidual(residual, plane[1:], float(disparity.mean()), float(1 - kept.mean()))


def blocks(
    residual: Float[np.ndarray, "height width"], size: int
) -> list[Float[np.ndarray, "block_height block_width"]]:
    """A patch cut into equal blocks of about `size` pixels: what may be drawn again by a bootstrap."""
    rows, columns = (max(1, round(extent / size)) for extent in residual.shape)
    return [
        block for band in np.array_split(residual, rows) for block in np.array_split(band, columns, axis=1)
    ]


def variogram(residual: Float[np.ndarray, "height width"]) -> Float[np.ndarray, "2 lags"]:
    """Half the mean squared difference of pixels that lie LAGS apart along u and along v [px^2].

    Differences do not know the mean, so what little of the noise the plane took away does not matter. NaN
    where the patch is too small.
    """
    found = np.full((2, len(LAGS)), np.nan)
    for row, image in enumerate((residual.T, residual)):
        for column, lag in enumerate(LAGS[len(image) > LAGS]):
            pairs = (image[lag:] - image[:-lag]) ** 2
            if np.isfinite(pairs).any():
                found[row, column] = 0.5 * np.nanmean(pairs)
    return found
