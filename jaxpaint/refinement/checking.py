"""What every method of refinement asks of its inputs."""

import numpy as np
from jaxtyping import Float

MIN_POINTS = 10


def checked_cloud(points: Float[np.ndarray, "N 3"]) -> Float[np.ndarray, "N 3"]:
    """The cloud, if it is one. Raises ValueError: finite float32 or float64 [N 3], at least 10 points."""
    points = np.asarray(points)
    if points.ndim != 2 or points.shape[1] != 3 or len(points) < MIN_POINTS:
        raise ValueError(f"points: shape {points.shape} found, (N, 3) with N >= {MIN_POINTS} is allowed")
    if points.dtype not in (np.float32, np.float64):
        raise ValueError(f"points: {points.dtype} found, float32 or float64 is allowed")
    if not np.isfinite(points).all():
        raise ValueError("points: NaN or infinity found, finite points are allowed")
    return points


def require_above(bound: float, **values: float) -> None:
    """Raises ValueError for the first of the named values that is not finite or not above `bound`."""
    for name, value in values.items():
        if not (np.isfinite(value) and value > bound):
            raise ValueError(f"{name}: {value} found, a finite number above {bound} is allowed")
