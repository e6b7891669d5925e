"""A straight line through a run of a scanner's echoes, without the bias that a noise along the beams brings.

Points are NumPy, relative to the scanner. Plain total least squares takes the noise to be the same in all
directions and turns slanted pieces of 0.3 m by some milliradians.
"""

import dataclasses

import numpy as np
from jaxtyping import Float

# Beams nearer to a line's direction than this count as if they were not [-]: the cosine of the incidence.
GRAZING = 0.05
_STEPS = 4


@dataclasses.dataclass(frozen=True)
class LineFit:
    """normal: unit, towards the scanner. middle: a point on the line [m]. along: where the beams meet the
    line, from the middle [m]. squarely: cosine of each beam's incidence. off: what the ranges are off by [m].
    """

    normal: Float[np.ndarray, "2"]
    middle: Float[np.ndarray, "2"]
    along: Float[np.ndarray, "m"]
    squarely: Float[np.ndarray, "m"]
    off: Float[np.ndarray, "m"]

    @property
    def tangent(self) -> Float[np.ndarray, "2"]:
        """The direction in which `along` counts."""
        return np.array([self.normal[1], -self.normal[0]])

    def place_sigma(self, sigma: float) -> float:
        """Standard deviation of the line's place, as root mean square over its length [m]."""
        rows = np.stack([np.ones_like(self.along), self.along], axis=1)
        weighed = rows / self.squarely[:, None]
        inverse = np.linalg.pinv(weighed.T @ weighed)
        first, last = self.along.min(), self.along.max()
        where = np.linspace(first, last, 9)
        over = np.stack([np.ones_like(where), where], axis=1)
        return float(sigma * np.sqrt(np.einsum("ni,ij,nj->n", over, inverse, over).mean()))


def total_least_squares(
    points: Float[np.ndarray, "m 2"],
) -> tuple[Float[np.ndarray, "2"], Float[np.ndarray, "2"]]:
    """The normal, towards the origin, and the middle of the points."""
    middle = points.mean(0)
    (xx, xy), (_, yy) = (points - middle).T @ (points - middle)
    heading = 0.5 * np.arctan2(2 * xy, xx - yy)
    normal = np.array([-np.sin(heading), np.cos(heading)])
    return (normal if normal @ middle <= 0 else -normal), middle


def fit_line(points: Float[np.ndarray, "m 2"]) -> LineFit:
    """The line from which the ranges differ least, by Gauss-Newton from total least squares."""
    normal, middle = total_least_squares(points)
    ranges = np.linalg.norm(points, axis=1)
    beams = points / ranges[:, None]
    fit = _measured(normal, middle, beams, ranges)
    for _ in range(_STEPS):
        rows = np.stack([np.ones_like(fit.along), fit.along], axis=1) / fit.squarely[:, None]
        shift, slope = np.linalg.lstsq(rows, fit.off, rcond=None)[0]
        turned = fit.normal - slope * fit.tangent
        middle = fit.middle + shift * fit.normal
        fit = _measured(turned / np.linalg.norm(turned), middle, beams, ranges)
    return fit


def _measured(normal, middle, beams, ranges) -> LineFit:
    squarely = np.maximum(-beams @ normal, GRAZING)
    reach = -(middle @ normal) / squarely
    tangent = np.array([normal[1], -normal[0]])
    along = (reach[:, None] * beams - middle) @ tangent
    # Where a beam ends beyond the line it is further from the scanner: against the normal.
    return LineFit(normal, middle, along, squarely, reach - ranges)
