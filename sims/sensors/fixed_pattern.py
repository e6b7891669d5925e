"""What two pictures of one surface share: what the camera errs by at a pixel, and the surface's own form."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.optimize import least_squares

_ACROSS, _DOWN = np.arange(-40, 41, 4), np.arange(-24, 25, 8)


@dataclass(frozen=True)
class FixedPattern:
    """camera: standard deviation of what stays at its pixel [px]; surface: of what moves with the surface
    [px]. length: of the correlation exp(-(d / length)^2 / 2) of either [px]. shared: standard deviation of
    all that is the same at a pixel [px], whatever moved.
    """

    camera: float
    surface: float
    length: float
    shared: float


def shared_covariance(
    first: Float[np.ndarray, "height width"], second: Float[np.ndarray, "height width"], u: int, v: int
) -> float:
    """Covariance of two pictures' residuals [px^2]: first at a pixel, second (u, v) pixels on.

    What is random in each picture is in neither, so at (0, 0) this is the variance of what they share.
    """
    height, width = first.shape
    a = first[max(0, -v) : height - max(0, v), max(0, -u) : width - max(0, u)]
    b = second[max(0, v) : height - max(0, -v), max(0, u) : width - max(0, -u)]
    return float(np.nanmean(a * b))


def fixed_pattern(
    first: Float[np.ndarray, "height width"], second: Float[np.ndarray, "height width"], shift: int
) -> FixedPattern:
    """Parts the residual [px] that two pictures share; in between the surface moved by `shift` [px] along u.

    The covariance at (u, v) is camera^2 rho(u, v) + surface^2 rho(u - shift, v). Of two pictures with a small
    shift the parts are hard to tell: they are worth one figure each.
    """
    u, v = np.meshgrid(_ACROSS, _DOWN)
    covariance = np.vectorize(lambda a, b: shared_covariance(first, second, a, b))(u, v)
    whole = shared_covariance(first, second, 0, 0)

    def miss(parts: np.ndarray) -> np.ndarray:
        camera, surface, length = parts
        stays = np.exp(-0.5 * (u**2 + v**2) / length**2)
        moves = np.exp(-0.5 * ((u - shift) ** 2 + v**2) / length**2)
        return ((camera * stays + surface * moves - covariance) / abs(whole)).ravel()

    start = [0.5 * abs(whole), 0.5 * abs(whole), 20.0]
    camera, surface, length = least_squares(miss, start, bounds=([0, 0, 2], [np.inf, np.inf, 200])).x
    return FixedPattern(
        float(np.sqrt(camera)), float(np.sqrt(surface)), float(length), float(np.sqrt(max(whole, 0.0)))
    )
