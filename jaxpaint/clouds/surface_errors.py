"""How far refined points and normals are from the true ones, in a few numbers."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float


@dataclass(frozen=True)
class DistanceStatistics:
    """Of distances to a surface: mean, root mean square and 95th percentile [m]."""

    mean: float
    rms: float
    p95: float


@dataclass(frozen=True)
class AngleStatistics:
    """Of angles: mean and 95th percentile [rad]."""

    mean: float
    p95: float


def point_to_surface(
    distance: Float[np.ndarray, "N"], valid: Bool[np.ndarray, "N"] | None = None
) -> DistanceStatistics:
    """Statistics of the valid points' distances from the true surface [m], signed or not.

    Infinite without valid points.
    """
    size = np.abs(np.asarray(distance, np.float64))
    size = size if valid is None else size[np.asarray(valid)]
    if len(size) == 0:
        return DistanceStatistics(np.inf, np.inf, np.inf)
    return DistanceStatistics(
        float(size.mean()), float(np.sqrt((size**2).mean())), float(np.percentile(size, 95))
    )


def normal_error(
    normals: Float[np.ndarray, "N 3"],
    truth: Float[np.ndarray, "N 3"],
    valid: Bool[np.ndarray, "N"] | None = None,
) -> AngleStatistics:
    """Statistics of the angles between unit normals, whatever their signs: atan2(|a x b|, |a . b|) [rad].

    Infinite without valid points.
    """
    found, true = np.asarray(normals, np.float64), np.asarray(truth, np.float64)
    # the arc cosine alone has no digits left at small angles
    across = np.linalg.norm(np.cross(found, true), axis=1)
    angle = np.arctan2(across, np.abs((found * true).sum(axis=1)))
    angle = angle if valid is None else angle[np.asarray(valid)]
    if len(angle) == 0:
        return AngleStatistics(np.inf, np.inf)
    return AngleStatistics(float(angle.mean()), float(np.percentile(angle, 95)))
