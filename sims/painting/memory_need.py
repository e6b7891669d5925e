"""How much memory a painting run needs, told before any world runs from the shapes of what it holds.

docs/scale.md has the figures that the constants were measured by, and a test holds small runs against them.
"""

import math
import os
from typing import NamedTuple

import numpy as np

from jaxpaint.compiling import CHUNK
from sims.paint import PaintGrid
from sims.painting.drive import WINDOW
from sims.painting.films import HELD
from sims.painting.job import Job
from sims.painting.lay import LOG_ROWS
from sims.painting.path import STATION_EVERY
from sims.painting.scan import MAX_POINTS, PLAN_ROWS
from sims.rollout import RECORD_EVERY
from sims.worlds import Kinematic

# Host memory of all programs of a run, most of it the compiler's [bytes]: measured, nothing compiled before.
# Programs from the cache take half of that.
_PROGRAMS, _MORE_FOR_PHYSICS = 1.7e9, 0.6e9
# Numbers in a row of a brush plan, in a base station, and in what a record holds beside the arm's joints, all
# of which are kept twice while blocks are put together.
_ROW, _STATION, _RECORDED = 19, 3, 15
# Numbers a record becomes: the true brush, and the log that paint is laid by, on the host and on the device.
_LAID = 6 + 2 * 20
# Worlds wait for their base: records are longer than plans, mostly by less than this.
_WAITING = 1.2
# Numbers of a point of the picture on a world's path, and of a stroke's runs and moves.
_POINT, _STROKE = 8, 80
# Numbers that a camera's pixel becomes while a world is looked at, and bytes of a scored cell on each thread.
_PIXEL, _SCORED = 24, 30
# Time of a stroke beyond its length at full speed: starts, stops, the lift to the next one [s].
_EACH_STROKE = 1.5
# Speed of moves with the pen up [m/s], and the time that a scan takes for each view [s].
_MOVE_SPEED, _EACH_VIEW = 0.25, 10.0
# What is kept of each finished world: its scores, as numbers and as a row of the results [bytes].
_KEPT = 4000


class MemoryNeed(NamedTuple):
    """Bytes. once: however many worlds, on the host. each: of a world of the group that runs, without its
    films. film: of a world's paint; what exceeds `HELD` is laid again when asked for. kept: of a finished
    world. device_once, device_each: on a device that has memory of its own.
    """

    once: int
    each: int
    film: int
    kept: int
    device_once: int
    device_each: int

    def host(self, group: int, worlds: int) -> int:
        """At the peak of a run of so many worlds in groups of `group`."""
        return int(self.once + group * self.each + min(group * self.film, HELD) + worlds * self.kept)

    def device(self, group: int) -> int:
        """The same on a device that has `group` worlds at a time."""
        return int(self.device_once + group * self.device_each + min(group * self.film, HELD))


def plan_time(job: Job, length: float, travel: float) -> float:
    """About how long a plan takes [s] for strokes and moves of these lengths [m]."""
    strokes, changes = int(np.max(np.asarray(job.stroke), initial=-1)) + 1, max(job.colours - 1, 0)
    way = length / float(job.speed) + travel / _MOVE_SPEED
    return way + _EACH_STROKE * strokes + float(job.tool_change) * changes


def memory_need(job: Job, grid: PaintGrid, *, seconds: float, cells: int, devices: int) -> MemoryNeed:
    """What a job needs whose plans take so many seconds.

    cells: of the grid on which paint is scored. devices: that this process computes on.
    """
    size = grid.cell.dtype.itemsize
    looking = size * _PIXEL * job.camera_place.shape[0] * job.camera.width * job.camera.height
    scoring = (os.cpu_count() or 1) * cells * _SCORED
    physics = 0 if isinstance(job.fidelity, Kinematic) else _MORE_FOR_PHYSICS
    planned, recorded = _numbers(job, seconds)
    apart = devices * looking + block_bytes(devices, size)
    return MemoryNeed(
        once=int(_PROGRAMS + physics + apart + scoring),
        each=size * (planned + recorded) + MAX_POINTS,
        film=job.colours * int(np.prod(grid.shape)) * size,
        kept=_KEPT,
        device_once=apart,
        device_each=size * (planned + recorded) + MAX_POINTS,
    )


def block_bytes(devices: int, size: int) -> int:
    """What a block of control steps takes while it runs: rows of the plan for chunks that are filled up, cut
    out on the host, placed, and worked on.
    """
    return 3 * size * devices * CHUNK * WINDOW * _ROW


def _numbers(job: Job, seconds: float) -> tuple[int, int]:
    """Numbers of a world: what it saw and plans, and what it did."""
    arm, dt, views = job.robot.home.shape[0], float(job.dt), job.camera_place.shape[0]
    scan = _up(_EACH_VIEW * views / dt, PLAN_ROWS) * (2 * (3 + arm) + 1 + _ROW)
    rows = _up(seconds / dt, PLAN_ROWS)
    plan = rows * (_ROW + _STATION / STATION_EVERY)
    strokes = int(np.max(np.asarray(job.stroke), initial=-1)) + 1
    path = job.picture.shape[0] * _POINT + strokes * _STROKE
    records = _up(_WAITING * rows / RECORD_EVERY, LOG_ROWS)
    return int(3 * MAX_POINTS + scan + plan + path), int(records * (2 * (_RECORDED + arm) + _LAID))


def _up(count: float, multiple: int) -> int:
    return multiple * math.ceil(count / multiple)
