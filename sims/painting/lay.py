"""What the run really did: the true brush, the paint it laid, and the scores of tracking."""

from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from jaxpaint.compiling import batched, one_by_one
from jaxpaint.kinematics.chain import KinematicChain, forward
from sims.paint import Brush, Paint, PaintGrid, contact, deposit, window_cells
from sims.painting.drive import Driven
from sims.painting.job import Job
from sims.rollout import RECORD_EVERY
from sims.scenes.charts import AbstractChart
from sims.scoring import Log, Tally, TrackingScore, accumulate, tracking_score

# Records are padded to a multiple of this, so that few lengths are ever compiled.
_ROWS = 512


class Truth(NamedTuple):
    """The true brush over the recorded time, map frame: position [m], axis into the wall, unit."""

    position: Float[np.ndarray, "worlds time 3"]
    axis: Float[np.ndarray, "worlds time 3"]


class Laid(NamedTuple):
    """Film thickness on the grid [m], volume past it [m^3], brush centre on the wall (u, v) [m], and
    tracking.
    """

    thickness: Float[Array, "worlds rows columns"]
    stray: Float[Array, " worlds"]
    uv: Float[Array, "worlds time 2"]
    tracking: TrackingScore


class _Layer(eqx.Module):
    """What laying needs of a job; the window's size is fixed on the host."""

    chart: AbstractChart
    brush: Brush
    grid: PaintGrid
    period: Float[Array, ""]
    window: int = eqx.field(static=True)


def _brush(chain: KinematicChain, q: Float[Array, "9"]):
    pose = forward(chain, q)
    return pose.p, pose.R[:, 2]


_BRUSH = batched(_brush, in_axes=(None, 0), chunk=256)


def true_brush(job: Job, driven: Driven) -> Truth:
    """The true brush from the true base and the arm, at every record."""
    q = np.concatenate([driven.record.base, driven.record.arm], axis=-1)
    position, axis = _BRUSH(job.robot.chain, jnp.asarray(q.reshape(-1, q.shape[-1])))
    shape = (*q.shape[:2], 3)
    return Truth(np.asarray(position).reshape(shape), np.asarray(axis).reshape(shape))


def _lay(layer: _Layer, log: Log):
    """One world: paint on the wall, and the tally of its tracking."""
    velocity = jnp.asarray(jnp.gradient(log.brush, axis=0)) / layer.period
    time = jnp.where(log.live, layer.period, 0.0)
    contacts = jax.vmap(lambda *row: contact(layer.chart, *row))(log.brush, log.axis, velocity, time, log.pen)
    paint = deposit(Paint.bare(layer.grid), layer.brush, layer.grid, contacts, window=layer.window)
    tally = accumulate(Tally.zero(log.brush.dtype), log, layer.chart)
    return paint.thickness, paint.stray, contacts.uv, tracking_score(tally)


_LAY = one_by_one(_lay, in_axes=(None, 0))


def lay(job: Job, grid: PaintGrid, driven: Driven, truth: Truth) -> Laid:
    """Lays the paint of all worlds and scores how they tracked."""
    record = driven.record
    log = Log(
        planned=record.planned,
        brush=jnp.asarray(truth.position),
        axis=jnp.asarray(truth.axis),
        pen=record.pen,
        live=record.live,
        odometry=record.odometry,
        base=record.base,
        halted=record.halted > 0.5,
    )
    length = record.pen.shape[1]
    log = jax.tree.map(lambda x: _padded(x, -(-length // _ROWS) * _ROWS), log)
    window = window_cells(job.brush, float(grid.cell))
    layer = _Layer(job.scene.chart, job.brush, grid, job.dt * RECORD_EVERY, window)
    thickness, stray, uv, tracking = _LAY(layer, log)
    return Laid(thickness, stray, uv[:, :length], tracking)


def _padded(rows: np.ndarray, length: int) -> np.ndarray:
    """Repeats the last row; padding is not live."""
    missing = length - rows.shape[1]
    tail = np.repeat(rows[:, -1:], missing, axis=1)
    return np.concatenate([rows, np.zeros_like(tail) if rows.dtype == bool else tail], axis=1)


def completed_and_fault(driven: Driven) -> tuple[np.ndarray, Bool[np.ndarray, " worlds"]]:
    """Which worlds came to the end of their plan, and which did not for lack of a solution."""
    steps = np.maximum(np.asarray(driven.state.steps), 1)
    return driven.completed, ~driven.completed & (np.asarray(driven.state.faults) > 0.01 * steps)
