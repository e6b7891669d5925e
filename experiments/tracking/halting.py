"""What halting is worth: one point of the study for a way to move the base, on one curve at one speed."""

import dataclasses
import math

import equinox as eqx
import jax.numpy as jnp
import numpy as np

from experiments.tracking.curves import CURVES
from experiments.tracking.follow import Followed, follow, median_interval
from experiments.tracking.park import parked
from experiments.tracking.study import Study, places_for, study_of
from experiments.tracking.variants import Variant, varied
from jaxpaint.decisions.thresholds import default_thresholds

THETAS = (0.1, 0.2, 0.4, 0.8, math.inf)
"""Base travel after which it halts [m]."""
REACHES = (0.24, 0.4, 0.5)
"""Of a place at which the rival parks [m]; the best one counts."""
Interval = tuple[float, float, float]
"""Median over worlds and its 95 % interval."""


@dataclasses.dataclass(frozen=True)
class Cell:
    """picture: a name of `CURVES`. speed: of the brush [m/s]. looking: whether what is seen corrects the
    belief; else odometry is all there is, as in S1.
    """

    picture: str
    speed: float
    looking: bool

    def __str__(self) -> str:
        sight = "looking" if self.looking else "odometry alone"
        return f"{self.picture}, {1e3 * self.speed:.0f} mm/s, {sight}"


@dataclasses.dataclass(frozen=True)
class Point:
    """error: total RMSE [m]; one that did not come to its end counts as infinitely far off. starts: how often
    the base sets off. time [s]. drift: largest of odometry [m].
    """

    error: Interval
    starts: Interval
    time: Interval
    drift: Interval

    def beats(self, rival: "Point") -> str:
        """By what this one is better for certain: `error`, or `time` at an error whose interval overlaps the
        rival's; else an empty word, as where too many worlds did not come to their end.
        """
        if not math.isfinite(self.error[2]):
            return ""
        if self.error[2] < rival.error[1]:
            return "error"
        no_worse = self.error[1] <= rival.error[2]
        return "time" if no_worse and self.time[2] < rival.time[1] else ""


def study_for(cell: Cell, seed: int = 0) -> Study:
    """The cell's curve before the wall of the tables, preset `s1-simulation`. seed: of the survey."""
    return study_of(CURVES[cell.picture](), speed=cell.speed, seed=seed)


def halting(study: Study, cell: Cell, theta: float, worlds: int, first: int) -> Point:
    """Our controller with this Theta. With Theta infinite there is no release margin either: the base is
    never held, and follows the brush.
    """
    seeing = _seeing(study, cell, theta)
    return _point(follow(seeing if math.isfinite(theta) else following(seeing), worlds, first))


def following(study: Study) -> Study:
    """The study without release margin: the base's places are as near to the brush as they get."""
    job = eqx.tree_at(lambda j: j.thresholds.release_margin, study.job, jnp.zeros_like(study.job.dt))
    plan = study.plan._replace(stations=places_for(job, np.asarray(study.plan.rows)))
    return dataclasses.replace(study, job=job, plan=plan)


def parking(study: Study, cell: Cell, reach: float, worlds: int, first: int) -> Point:
    """Park, operate, park, with segments that lie within `reach` [m] of the base's place."""
    return _point(follow(parked(_seeing(study, cell, math.inf), reach), worlds, first))


def _seeing(study: Study, cell: Cell, theta: float) -> Study:
    on = cell.looking
    return varied(study, Variant(default_thresholds(halt_travel=theta), lidar=on, depth=on, strokes=on))


def _point(run: Followed) -> Point:
    error, time = (np.where(run.completed, x, np.inf) for x in (run.score.total, run.time))
    return Point(
        *(median_interval(np.asarray(x)) for x in (error, run.starts, time, run.score.drift_largest))
    )
