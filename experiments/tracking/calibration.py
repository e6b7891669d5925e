"""How much odometry noise the papers' robot has: so much that its controller, as printed, errs as published.

Done once for each preset, on worlds that nothing else uses; what came out stands in `sims.noise`.
"""

import dataclasses

import equinox as eqx
import numpy as np

from experiments.tracking.curves import lemniscate
from experiments.tracking.follow import follow
from experiments.tracking.study import Study, study_of
from experiments.tracking.variants import literal, varied
from sims.noise import scaled
from sims.sight import drift_of

FIRST = 2_000_000
"""Index of the first world."""
WORLDS = 192
THETAS = (0.02, 0.1, 0.4, float("inf"))
"""Theta is not printed: the one best for the printed controller counts [m]."""


@dataclasses.dataclass(frozen=True)
class Calibration:
    """factor: units of noise (`sims.noise.scaled`). theta: the best one there [m]. error: median RMSE [m]."""

    factor: float
    theta: float
    error: float


def calibrate(published: float, *, most: float = 20.0, rounds: int = 8) -> Calibration:
    """The factor at which the printed controller's median error is `published` [m], by bisection.

    Raises ValueError where it errs more without any noise, or less at `most`.
    """
    study = study_of(lemniscate())
    low, high = _best(study, 0.0), _best(study, most)
    if not low.error < published < high.error:
        raise ValueError(f"published: {published} m, allowed: {low.error} to {high.error}")
    for _ in range(rounds):
        middle = _best(study, (low.factor + high.factor) / 2)
        low, high = (middle, high) if middle.error < published else (low, middle)
    return min(low, high, key=lambda c: abs(c.error - published))


def _best(study: Study, factor: float) -> Calibration:
    """The printed controller with the best Theta at so many units of noise."""
    found = [(literal_error(study, factor, theta), theta) for theta in THETAS]
    error, theta = min(found)
    return Calibration(factor, theta, error)


def literal_error(study: Study, factor: float, theta: float) -> float:
    """Median of the printed controller's RMSE [m]."""
    noisy = with_noise(varied(study, literal(theta)), factor)
    return float(np.median(follow(noisy, WORLDS, FIRST).score.total))


def with_noise(study: Study, factor: float) -> Study:
    """The study under so many units of odometry noise, of which the robot knows the size."""
    noise = scaled(factor).odometry
    drift = drift_of(noise, study.job.limits.drive)
    job = eqx.tree_at(lambda j: (j.noise.odometry, j.sight.drift), study.job, (noise, drift))
    return dataclasses.replace(study, job=job)
