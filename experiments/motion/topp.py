"""Time-optimal path parametrisation: the least time for a path in joint space, as a bound for planners.

Acceleration may jump. At node i of a grid in the path's parameter s, K = s'^2 and u = s'' obey rows
|A u + B K + g| <= c (accelerations, torques) and K <= V (speeds). Backwards the largest K from which the rest
can be braked, then forwards as steep as can be (Pham and Pham's reachability analysis).
"""

import numpy as np
from jaxtyping import Float

_BISECTIONS = 40


def fastest_time(
    A: Float[np.ndarray, "paths nodes rows"],
    B: Float[np.ndarray, "paths nodes rows"],
    offset: Float[np.ndarray, "paths nodes rows"],
    limit: Float[np.ndarray, "paths nodes rows"],
    V: Float[np.ndarray, "paths nodes"],
) -> Float[np.ndarray, " paths"]:
    """Least time from rest to rest [s] of each path, s from 0 to 1 in equal steps."""
    step = 1 / (A.shape[1] - 1)
    A = np.where(np.abs(A) < 1e-9, 1e-9, A)
    # every row as u <= (upper - B K) / A and u >= (lower - B K) / A, by the sign of A
    sign = np.sign(A)
    slope = -B / A
    high = (np.where(sign > 0, limit, -limit) - offset) / A
    low = (np.where(sign > 0, -limit, limit) - offset) / A
    most = _most(low, high, slope, V)
    within = most.copy()
    within[:, -1] = 0
    for i in range(A.shape[1] - 2, -1, -1):
        # K + 2 step u <= next, with the least u of each row
        rate = 1 + 2 * step * slope[:, i]
        room = within[:, i + 1, None] - 2 * step * low[:, i]
        reach = np.where(rate > 1e-9, room / np.where(rate > 1e-9, rate, 1), np.inf).min(-1)
        within[:, i] = np.clip(np.minimum(most[:, i], reach), 0, None)
    K = np.zeros_like(within)
    for i in range(A.shape[1] - 1):
        u = (high[:, i] + slope[:, i] * K[:, i, None]).min(-1)
        K[:, i + 1] = np.clip(np.minimum(within[:, i + 1], K[:, i] + 2 * step * u), 0, None)
    root = np.sqrt(K)
    return (2 * step / np.maximum(root[:, 1:] + root[:, :-1], 1e-9)).sum(1)


def _most(low, high, slope, V):
    """The largest K up to V with any u at all, by bisection."""
    below, above = np.zeros_like(V), V.copy()
    for _ in range(_BISECTIONS):
        K = (below + above) / 2
        lower = (low + slope * K[..., None]).max(-1)
        upper = (high + slope * K[..., None]).min(-1)
        fits = lower <= upper
        below, above = np.where(fits, K, below), np.where(fits, above, K)
    return np.where(((low + slope * V[..., None]).max(-1) <= (high + slope * V[..., None]).min(-1)), V, below)
