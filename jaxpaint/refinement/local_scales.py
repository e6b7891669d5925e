"""How dense and how noisy a cloud is, point by point: the units of every setting of refinement.

In a scan both grow with distance, spacing with it and noise with its square, so no length in metres is right
for a whole cloud.
"""

import numpy as np
from jaxtyping import Float

from jaxpaint.refinement.local_planes import fit_planes, heights
from jaxpaint.refinement.neighbourhoods import Neighbourhoods

SPACING_NEIGHBOURS = 16
NOISE_NEIGHBOURS = 64
_CALMED = 2
"""How often a point takes the lower quartile of its neighbours."""
_GAUSSIAN = 1.4826
"""Standard deviation of a Gaussian over its median absolute deviation."""


def spacing(
    points: Float[np.ndarray, "N 3"], *, neighbours: int = SPACING_NEIGHBOURS
) -> Float[np.ndarray, "N"]:
    """Typical distance of neighbours at every point [m]: r_k sqrt(pi / k), r_k the distance of the k-th.

    On a surface with one point in each square of side s it is s. Zero where more than `neighbours` points
    coincide. Raises ValueError for what is no finite cloud of at least 10 points.
    """
    return local_spacing(Neighbourhoods.of(points, neighbours + 1), neighbours)


def noise(points: Float[np.ndarray, "N 3"], *, neighbours: int = NOISE_NEIGHBOURS) -> Float[np.ndarray, "N"]:
    """Standard deviation of the noise across the surface at every point [m], robust against edges.

    Roughness is 1.4826 MAD of the heights of the k nearest over their plane of total least squares, times
    sqrt(k / (k - 3)) for the three numbers fitted. Where neighbourhoods reach over an edge it is far more
    than noise, so a point takes the lower quartile of its neighbours, and once more of those, which reaches
    neighbourhoods beside the edge. On simulated depth images this is 0.8 of the true figure on walls (errors
    of neighbouring pixels are correlated, and planes follow them) and 1.0 to 1.1 along edges.
    Raises ValueError for what is no finite cloud of at least 10 points.
    """
    return local_noise(Neighbourhoods.of(points, neighbours), neighbours)


def local_spacing(near: Neighbourhoods, neighbours: int = SPACING_NEIGHBOURS) -> Float[np.ndarray, "N"]:
    """`spacing` from neighbours that are already known."""
    near = near.nearest(neighbours + 1)
    far = near.points[:, near.index[:, -1]] - near.points
    return np.sqrt(np.einsum("an,an->n", far, far) * near.points.dtype.type(np.pi / (near.k - 1)))


def local_noise(near: Neighbourhoods, neighbours: int = NOISE_NEIGHBOURS) -> Float[np.ndarray, "N"]:
    """`noise` from neighbours that are already known."""
    near = near.nearest(neighbours)
    found = near.each(lambda rows: _roughness(near.around(rows)))
    quarter = near.k // 4
    for _ in range(_CALMED):
        found = near.each(
            lambda rows, at=found: np.partition(at[near.index[rows]], quarter, axis=1)[:, quarter]
        )
    return found


def _roughness(around: Float[np.ndarray, "3 n k"]) -> Float[np.ndarray, "n"]:
    """Robust standard deviation of neighbourhoods about their planes [m]."""
    k = around.shape[2]
    height = heights(around, *fit_planes(around))
    off = np.abs(height - np.median(height, axis=1, keepdims=True))
    scale = _GAUSSIAN * np.sqrt(k / max(k - 3, 1))
    return (scale * np.median(off, axis=1)).astype(around.dtype)
