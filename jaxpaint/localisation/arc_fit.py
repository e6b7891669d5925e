"""A circle through a run of a scanner's echoes: whether a surface is evenly curved, and how."""

import dataclasses

import numpy as np
from jaxtyping import Float

from jaxpaint.localisation.line_fit import GRAZING

_STEPS = 5


@dataclasses.dataclass(frozen=True)
class ArcFit:
    """center [m], radius [m]. faces: 1 where the scanner sees the outside of a column, -1 inside a niche.

    angle: of the echoes about the centre, continuous [rad]. squarely: cosine of each beam's incidence. off:
    what the ranges are off by [m].
    """

    center: Float[np.ndarray, "2"]
    radius: float
    faces: float
    angle: Float[np.ndarray, "m"]
    squarely: Float[np.ndarray, "m"]
    off: Float[np.ndarray, "m"]

    def place_sigma(self, sigma: float) -> float:
        """Standard deviation of the arc's place along its normal, as root mean square over its length [m]."""
        rows = self._rows(self.angle) / self.squarely[:, None]
        inverse = np.linalg.pinv(rows.T @ rows)
        over = self._rows(np.linspace(self.angle.min(), self.angle.max(), 9))
        return float(sigma * np.sqrt(np.einsum("ni,ij,nj->n", over, inverse, over).mean()))

    @staticmethod
    def _rows(angle):
        return np.stack([np.cos(angle), np.sin(angle), np.ones_like(angle)], axis=1)


def fit_arc(points: Float[np.ndarray, "m 2"]) -> ArcFit | None:
    """The circle from which the ranges differ least; None where none is found.

    points: relative to the scanner. By Gauss-Newton from the algebraic circle |p|^2 = 2 c . p + const.
    """
    middle = points.mean(0)
    local, beams = points - middle, points / np.linalg.norm(points, axis=1)[:, None]
    rows = np.concatenate([2 * local, np.ones((len(local), 1))], axis=1)
    x, y, rest = np.linalg.lstsq(rows, (local**2).sum(1), rcond=None)[0]
    found = np.array([x, y, np.sqrt(max(rest + x * x + y * y, 1e-12))])
    for _ in range(_STEPS):
        outward, off, squarely = _measured(found, local, beams)
        rows = np.concatenate([outward, np.ones((len(off), 1))], axis=1) / squarely[:, None]
        found = found + np.linalg.lstsq(rows, off, rcond=None)[0]
        if not (np.isfinite(found).all() and found[2] > 0):
            return None
    outward, off, squarely = _measured(found, local, beams)
    faces = -float(np.sign((outward * beams).sum()) or 1.0)
    angle = np.unwrap(np.arctan2(outward[:, 1], outward[:, 0]))
    return ArcFit(middle + found[:2], float(found[2]), faces, angle, squarely, off)


def _measured(circle, local, beams):
    """Outward normals, how far the ranges are off along their beams, and the cosines of incidence."""
    arm = local - circle[:2]
    reach = np.linalg.norm(arm, axis=1)
    outward = arm / np.maximum(reach, 1e-12)[:, None]
    squarely = np.maximum(np.abs((outward * beams).sum(1)), GRAZING)
    return outward, (reach - circle[2]) / squarely, squarely
