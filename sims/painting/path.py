"""From the scanned cloud to a plan: the picture on the surface, timed, with stations (S1 III-B)."""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from jaxpaint.clouds.sparse import sparse
from jaxpaint.compiling import one_by_one
from jaxpaint.mapping.mapped import count_by_cause
from jaxpaint.mapping.moves import MoveSettings
from jaxpaint.mapping.raycast import cast
from jaxpaint.mapping.timeline import BrushPath, PathSettings, plan_path, sample
from jaxpaint.planning import ReachWindow, StationSettings, plan_stations
from sims.painting.drive import BrushPlan
from sims.painting.job import Job
from sims.painting.scan import steps_for

# Every so many control steps a base station is planned: half a second, in which a brush goes 15 mm.
STATION_EVERY = 25
# A base in the middle of what it serves stays there: its brush is nearer than the release margin, by this
# share of it.
_WITHIN = 0.8
# With a small margin, or none, the base still does not go to and fro for less than this [m].
_NARROWEST = 0.1
# Least distance of the base's footprint from anything seen [m]: many times what odometry drifts in a run.
_CLEARANCE = 0.12
# So many points of the cloud, this far apart or further [m], stand for the surface where distances are asked.
_SPARSE, _APART = 512, 0.05
# Strokes are cut where the surface has no point: there is room for so many runs of each, and for some more.
_RUNS_EACH, _MORE_RUNS = 2, 96


class Painting(NamedTuple):
    """What one world is going to paint.

    path: on the surface. causes: number of points by `Cause`. obstacles: sparse points of the surface (NaN is
    no point). plan: for the whole-body controller.
    """

    path: BrushPath
    causes: Int[Array, " causes"]
    obstacles: Float[Array, "m 3"]
    plan: BrushPlan


def map_picture(job: Job, cloud: Float[Array, "n 3"], valid: Bool[Array, " n"]):
    """The picture's strokes on one world's cloud, as a timed path."""
    mapped = cast(job.picture, job.canvas, cloud, valid, job.mapping)
    obstacles = sparse(cloud, valid, count=_SPARSE, size=_APART)
    settings = PathSettings(speed=job.speed, move=MoveSettings(change_time=job.tool_change))
    path = plan_path(
        mapped,
        job.stroke,
        job.canvas.u_axis,
        settings,
        obstacles=obstacles,
        colour=job.colour,
        max_runs=_MORE_RUNS if job.colour is None else _MORE_RUNS + _RUNS_EACH * job.colour.shape[0],
    )
    return path, count_by_cause(path.status), obstacles


def brush_rows(job: Job, path: BrushPath, count: Int[Array, " t"]) -> Float[Array, "t 19"]:
    """The path at every control step, as rows of `opt.wbc.Reference`."""
    timed = sample(path, job.dt, count.shape[0])
    flat = timed.rotation.reshape(-1, 9)
    pen = timed.pen[:, None].astype(flat.dtype)
    return jnp.concatenate([timed.position, flat, timed.velocity, timed.angular_velocity, pen], axis=1)


def stations(job: Job, rows: Float[Array, "t 19"], obstacles: Float[Array, "m 3"]) -> Float[Array, "s 3"]:
    """Base poses along the path, away from what camera and lidar saw."""
    coarse = rows[::STATION_EVERY]
    echoes = jnp.concatenate([job.echoes, jnp.zeros_like(job.echoes[:, :1])], axis=1)
    obstacles = jnp.concatenate([obstacles, echoes])
    real = jnp.isfinite(obstacles).all(-1)
    width = 2 * _WITHIN * job.thresholds.release_margin
    reach = ReachWindow(jnp.maximum(width, _NARROWEST), job.settings.yaw_lever)
    settings = StationSettings(reach, jnp.asarray(_CLEARANCE), job.robot.footprint)
    surface = jnp.where(real[:, None], obstacles, 0.0)
    return plan_stations(
        coarse[:, :3],
        coarse[:, 5:12:3],
        coarse[:, 18],
        surface,
        real.astype(rows.dtype),
        job.limits.home,
        settings,
    )


_MAP = one_by_one(map_picture, in_axes=(None, 0, 0))
_ROWS = one_by_one(brush_rows, in_axes=(None, 0, None))
_STATIONS = one_by_one(stations, in_axes=(None, 0, 0))


def plan_painting(job: Job, cloud: Float[Array, "w n 3"], valid: Bool[Array, "w n"]) -> Painting:
    """Maps and plans in all worlds."""
    path, causes, obstacles = _MAP(job, cloud, valid)
    count = steps_for(job, np.asarray(path.end))
    rows = _ROWS(job, path, jnp.zeros(count, jnp.int32))
    places = _STATIONS(job, rows, obstacles)
    step = np.full(path.end.shape, float(job.dt), np.asarray(path.end).dtype)
    every, none = step * STATION_EVERY, 0 * step
    plan = BrushPlan(np.asarray(rows), step, none, np.asarray(places), every, none, np.asarray(path.end))
    return Painting(path, causes, obstacles, plan)
