"""Park, operate, park: the rival that S1 names. The base moves only between segments, and the brush waits."""

import dataclasses
import itertools

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from experiments.tracking.study import Study, padded_count, places_for

# The brush stops and goes on within this time [s]; so long it is up at least, while the base gets going.
_RAMP, _UP = 0.1, 0.1
# The next station is there this long before the pen is up [s]: rows are read between neighbours, and a clock
# that waits must not see part of the way.
_AHEAD = 0.05
# Stations nearer than this are one [m].
_SAME = 1e-3


def parked(study: Study, reach: float) -> Study:
    """The same curve in the fewest segments that lie within `reach` [m] of a place of the base.

    Between two segments the pen is up, and the plan's clock waits until the base has arrived
    (`Thresholds.park`); no base speed is too fast for it. Halting and its margins are left out.
    """
    job = eqx.tree_at(
        lambda j: j.thresholds.release_margin, study.job, jnp.asarray(reach, study.job.dt.dtype)
    )
    rows, dt = np.asarray(study.plan.rows), float(study.job.dt)
    places = places_for(job, rows)
    every = float(study.plan.station_step)
    live = places[: int(np.ceil(float(study.plan.duration) / every)) + 1]
    changes = np.flatnonzero(np.linalg.norm(np.diff(live, axis=0), axis=1) > _SAME)
    edges = np.concatenate([[0.0], (changes + 0.5) * every, [float(study.plan.duration)]])
    duration = edges[-1] + _RAMP * (len(edges) - 1) + _UP * len(changes)
    time = dt * np.arange(padded_count(duration, dt))
    clock, segment, up = _cut(time, edges)
    plan = study.plan._replace(
        rows=_at(rows, clock, dt, up),
        stations=live[np.append(changes, len(live) - 1)][segment].astype(places.dtype),
        station_step=np.asarray(dt, rows.dtype),
        duration=np.asarray(duration, rows.dtype),
    )
    changed = "halt_travel", "dwell", "release_margin", "low_speed_scale", "park"
    values = np.inf, 0.0, 0.0, 1e3, 1.0
    thresholds = dataclasses.replace(
        job.thresholds, **{k: jnp.asarray(x, job.dt.dtype) for k, x in zip(changed, values, strict=True)}
    )
    return Study(dataclasses.replace(job, thresholds=thresholds), plan, study.length)


def _cut(time: Float[np.ndarray, " t"], edges: Float[np.ndarray, " e"]):
    """Where the uncut plan is at each time [s], which segment the base stands for, where the pen is up."""
    clock, segment, up = np.full_like(time, edges[-1]), np.zeros(len(time), int), np.zeros(len(time), bool)
    begin = 0.0
    for k, (first, last) in enumerate(itertools.pairwise(edges)):
        own = (time >= begin) & (time < begin + last - first + _RAMP)
        clock[own] = first + _from_rest_to_rest(time[own] - begin, last - first)
        segment[time >= begin - _UP - _AHEAD] = k
        begin += last - first + _RAMP
        up |= (time >= begin) & (time < begin + _UP) & (k < len(edges) - 2)
        clock[(time >= begin) & (time < begin + _UP)] = last
        begin += _UP
    return clock, segment, up


def _from_rest_to_rest(time: Float[np.ndarray, " t"], length: float) -> Float[np.ndarray, " t"]:
    """A clock that goes `length` in `length + _RAMP`."""
    left = length + _RAMP - time
    ends = np.where(time < left, time, left)
    way = np.where(ends < _RAMP, ends**2 / (2 * _RAMP), ends - _RAMP / 2)
    return np.where(time < left, way, length - way)


def _at(rows: Float[np.ndarray, "t 19"], clock: Float[np.ndarray, " s"], dt: float, up) -> np.ndarray:
    """The rows where the clock is, at its rate."""
    place = np.clip(clock / dt, 0, len(rows) - 1)
    low = np.minimum(place.astype(int), len(rows) - 2)
    share = (place - low)[:, None]
    found = (1 - share) * rows[low] + share * rows[low + 1]
    found[:, 12:18] *= np.gradient(clock, dt)[:, None]
    found[:, 18] *= ~up
    return found.astype(rows.dtype)
