"""The planes that fit many neighbourhoods at once."""

import numpy as np
from jaxtyping import Float


def fit_planes(
    around: Float[np.ndarray, "3 n k"], weight: Float[np.ndarray, "n k"] | None = None
) -> tuple[Float[np.ndarray, "3 n"], Float[np.ndarray, "3 n"]]:
    """Centre [m] and unit normal of the plane of total least squares through each neighbourhood.

    The normal is the axis of least variance of the weighted covariance (PCA, Hoppe et al., 1992); its sign is
    open. Points that determine no plane, or weights that are all zero, give some unit normal.
    """
    share = shares(np.ones_like(around[0]) if weight is None else weight)
    centre = np.einsum("ank,nk->an", around, share)
    about = around - centre[..., None]
    weighed = about * share
    covariance = np.empty((around.shape[1], 3, 3))
    # eigh reads the lower triangle alone
    for row, column in ((0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2)):
        covariance[:, row, column] = np.einsum("nk,nk->n", weighed[row], about[column])
    normal = np.linalg.eigh(covariance)[1][:, :, 0]
    return centre, np.ascontiguousarray(normal.T, dtype=around.dtype)


def shares(weight: Float[np.ndarray, "n k"]) -> Float[np.ndarray, "n k"]:
    """Weights over their sum; alike where the sum is zero."""
    total = weight.sum(axis=1, keepdims=True)
    return np.where(total > 0, weight / np.where(total > 0, total, 1), 1 / weight.shape[1])


def closeness(around: Float[np.ndarray, "3 n k"], sigma: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n k"]:
    """exp(-d^2 / 2 sigma^2) of the neighbours' distances d from their point; see `gaussian`."""
    return gaussian(np.einsum("ank,ank->nk", around, around), sigma)


def gaussian(square: Float[np.ndarray, "n k"], sigma: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n k"]:
    """exp(-square / 2 sigma^2) with one sigma for each row; for sigma 0 it is 1 at 0 and 0 elsewhere."""
    # 1e30 leaves single precision room for the product
    tightness = 0.5 / np.maximum(sigma.astype(np.float64) ** 2, 5e-31)
    return np.exp(-square * tightness.astype(square.dtype)[:, None])


def heights(
    around: Float[np.ndarray, "3 n k"], centre: Float[np.ndarray, "3 n"], normal: Float[np.ndarray, "3 n"]
) -> Float[np.ndarray, "n k"]:
    """Signed distances of the neighbours from planes [m]."""
    return np.einsum("ank,an->nk", around, normal) - np.einsum("an,an->n", centre, normal)[:, None]
