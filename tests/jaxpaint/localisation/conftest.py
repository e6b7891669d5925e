"""Places that a planar scanner can see: segments and discs, with a ray caster of their own."""

import dataclasses

import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.localisation import outline_of

SIGMA = 0.01
"""Standard deviation of a range [m]."""
SURVEY = np.linspace(-2.356, 2.356, 541)
"""Bearings of the survey before a job [rad]."""
LOOK = np.linspace(-2.356, 2.356, 90)
"""Bearings of a look [rad]."""


@dataclasses.dataclass(frozen=True)
class Place:
    """segments: (x0, y0, x1, y1). discs: (x, y, radius), seen from outside. stand: a survey's (x, y, yaw)."""

    segments: tuple
    discs: tuple
    stand: tuple

    def ranges(self, pose, bearings=LOOK, *, noise=None):
        """Along the beams of a scanner at (x, y, yaw) [m]; infinite where nothing is met."""
        heading = pose[2] + np.asarray(bearings)
        d, o = np.stack([np.cos(heading), np.sin(heading)], axis=1), np.asarray(pose[:2], float)
        best = np.full(len(d), np.inf)
        with np.errstate(divide="ignore", invalid="ignore"):
            for x0, y0, x1, y1 in self.segments:
                a, e = np.array([x0, y0]), np.array([x1 - x0, y1 - y0])
                n = np.array([-e[1], e[0]])
                t = ((a - o) @ n) / (d @ n)
                u = ((o + t[:, None] * d - a) @ e) / (e @ e)
                best = np.where((t > 0) & (u >= 0) & (u <= 1), np.minimum(best, t), best)
            for x, y, radius in self.discs:
                m = o - np.array([x, y])
                t = -(d @ m) - np.sqrt((d @ m) ** 2 - m @ m + radius**2)
                best = np.where(t > 0, np.minimum(best, t), best)
        return best if noise is None else best + SIGMA * noise.normal(size=len(best))

    def outline(self, noise=None, *, count=32):
        """What a survey from `stand` makes of it."""
        ranges = self.ranges(self.stand, SURVEY, noise=noise)
        heading = self.stand[2] + SURVEY
        reach = np.where(ranges < 20, ranges, np.nan)[:, None]
        echoes = np.array(self.stand[:2]) + reach * np.stack([np.cos(heading), np.sin(heading)], axis=1)
        return outline_of(echoes, np.array(self.stand[:2]), count=count, range_sigma=SIGMA)

    def gap(self, points):
        """Distance of points from the nearest surface [m]."""
        gaps = [abs(np.linalg.norm(points - np.array(disc[:2]), axis=-1) - disc[2]) for disc in self.discs]
        for x0, y0, x1, y1 in self.segments:
            a, e = np.array([x0, y0]), np.array([x1 - x0, y1 - y0])
            u = np.clip(((points - a) @ e) / (e @ e), 0, 1)
            gaps.append(np.linalg.norm(points - a - u[..., None] * e, axis=-1))
        return np.min(gaps, axis=0)


def _room(width, depth):
    return ((0, 0, width, 0), (width, 0, width, depth), (width, depth, 0, depth), (0, depth, 0, 0))


PLACES = {
    "flat": Place(((3, -6, 3, 6),), (), (1.8, 0.2, 0.1)),
    "corner": Place(((3, -6, 3, 2), (3, 2, -6, 2)), (), (1.8, 1.0, 0.8)),
    "room": Place(_room(4, 5), (), (1.5, 2.0, 0.7)),
    "column": Place((), ((4, 0, 2),), (1.0, 0.0, 0.0)),
}


@pytest.fixture(scope="session")
def places():
    """Places by name: flat, corner, room, column (2 m of radius, 1 m away)."""
    return PLACES


@pytest.fixture(scope="session")
def bearings():
    """Of a look: 90 beams over 270 degrees [rad]."""
    return jnp.asarray(LOOK)
