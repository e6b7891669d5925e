"""Time-optimal path parametrisation: the least time for a path in joint space, as a bound for planners.

Acceleration may jump. At node i of a grid in the path's parameter s, K = s'^2 and u = s'' obey rows
|A u + B K + C sqrt(K) + g| <= c (accelerations, torques with damping) and K <= V (speeds). Backwards the
largest K from which the rest can be braked, then forwards as steep as can be (Pham and Pham's reachability
analysis).
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
    C: Float[np.ndarray, "paths nodes rows"] | float = 0.0,
) -> Float[np.ndarray, " paths"]:
    """Least time from rest to rest [s] of each path, s from 0 to 1 in equal steps."""
    step = 1 / (A.shape[1] - 1)
    A = np.where(np.abs(A) < 1e-9, 1e-9, A)
    # every row as u <= (upper - B K) / A and u >= (lower - B K) / A, by the sign of A
    sign = np.sign(A)
    slope, drag = -B / A, np.broadcast_to(-C / A, A.shape)
    high = (np.where(sign > 0, limit, -limit) - offset) / A
    low = (np.where(sign > 0, -limit, limit) - offset) / A
    most = _most(low, high, slope, drag, V)
    within = most.copy()
    within[:, -1] = 0
    for i in range(A.shape[1] - 2, -1, -1):
        # K + 2 step u <= next, with the least u of each row: a quadratic in sqrt(K)
        rate, half = 1 + 2 * step * slope[:, i], step * drag[:, i]
        room = within[:, i + 1, None] - 2 * step * low[:, i]
        root = np.sqrt(np.maximum(half * half + rate * room, 0)) - half
        reach = np.where(rate > 1e-9, (np.maximum(root, 0) / np.where(rate > 1e-9, rate, 1)) ** 2, np.inf)
        within[:, i] = np.minimum(most[:, i], reach.min(-1))
    K = np.zeros_like(within)
    for i in range(A.shape[1] - 1):
        now = K[:, i, None]
        u = (high[:, i] + slope[:, i] * now + drag[:, i] * np.sqrt(now)).min(-1)
        K[:, i + 1] = np.clip(np.minimum(within[:, i + 1], K[:, i] + 2 * step * u), 0, None)
    root = np.sqrt(K)
    return (2 * step / np.maximum(root[:, 1:] + root[:, :-1], 1e-9)).sum(1)


def _most(low, high, slope, drag, V):
    """The largest K up to V with any u at all, by bisection."""

    def fits(K):
        shift = slope * K[..., None] + drag * np.sqrt(K)[..., None]
        return (low + shift).max(-1) <= (high + shift).min(-1)

    below, above = np.zeros_like(V), V.copy()
    for _ in range(_BISECTIONS):
        K = (below + above) / 2
        good = fits(K)
        below, above = np.where(good, K, below), np.where(good, above, K)
    return np.where(fits(V), V, below)
