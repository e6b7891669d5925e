"""What the run really did: the true brush, the paint it laid, and the scores of tracking."""

from collections.abc import Callable
from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from jaxpaint.compiling import batched, one_by_one, repeated
from jaxpaint.kinematics.chain import KinematicChain
from sims.paint import Brush, Paint, PaintGrid, contact, deposit, window_cells
from sims.painting.drive import Driven
from sims.painting.films import Films, Group, split
from sims.painting.job import Job
from sims.rollout import RECORD_EVERY
from sims.scenes.charts import AbstractChart
from sims.scoring import (
    Log,
    PaintScore,
    Tally,
    TrackingScore,
    Wanted,
    accumulate,
    score_paint_worlds,
    tracking_score,
)
from sims.truth import Calibration
from sims.truth import true_brush as brush_of

# Records are padded to a multiple of this, so that few lengths are ever compiled.
LOG_ROWS = 512


class Truth(NamedTuple):
    """The true brush over the recorded time, map frame: position [m], axis into the wall, unit."""

    position: Float[np.ndarray, "worlds time 3"]
    axis: Float[np.ndarray, "worlds time 3"]


class Laid(NamedTuple):
    """Film thickness on the grid [m], volume past it [m^3], brush centre on the wall (u, v) [m], tracking,
    and the colour in hand (None where there is only one). Films that nobody asks for again may be dropped.
    """

    thickness: Films | None
    stray: Float[Array, " worlds"]
    uv: Float[Array, "worlds time 2"]
    tracking: TrackingScore
    colour: Int[np.ndarray, "worlds time"] | None = None

    @property
    def films(self) -> Films:
        """The films. Raises ValueError where they were dropped."""
        if self.thickness is None:
            raise ValueError("the films of these worlds were dropped")
        return self.thickness


class _Layer(eqx.Module):
    """What laying needs of a job; the window's size and the number of colours are fixed on the host."""

    chart: AbstractChart
    brush: Brush
    grid: PaintGrid
    period: Float[Array, ""]
    window: int = eqx.field(static=True)
    colours: int = eqx.field(static=True)


def _brush(chain: KinematicChain, wrong: Calibration, base, tilt, arm):
    pose = brush_of(chain, wrong, base, tilt, arm)
    return pose.p, pose.R[:, 2]


_BRUSH = batched(_brush, in_axes=(None, None, 0, 0, 0), chunk=256)


def true_brush(job: Job, driven: Driven) -> Truth:
    """The true brush from the true base and the arm, at every record."""
    places = driven.record.base, driven.record.tilt, driven.record.arm
    rows = (jnp.asarray(x.reshape(-1, x.shape[-1])) for x in places)
    wrong = repeated(job.calibration, driven.record.pen.shape[1])
    position, axis = _BRUSH(job.robot.chain, wrong, *rows)
    shape = (*driven.record.pen.shape, 3)
    return Truth(np.asarray(position).reshape(shape), np.asarray(axis).reshape(shape))


def _lay(layer: _Layer, log: Log, colour: Int[Array, " time"] | None):
    """One world: paint on the wall, and the tally of its tracking."""
    velocity = jnp.asarray(jnp.gradient(log.brush, axis=0)) / layer.period
    time = jnp.where(log.live, layer.period, 0.0)
    contacts = jax.vmap(lambda *row: contact(layer.chart, *row))(log.brush, log.axis, velocity, time, log.pen)
    bare = Paint.bare(layer.grid, layer.colours)
    paint = deposit(bare, layer.brush, layer.grid, contacts, window=layer.window, colour=colour)
    tally = accumulate(Tally.zero(log.brush.dtype), log, layer.chart)
    return paint.thickness, paint.stray, contacts.uv, tracking_score(tally)


_LAY = one_by_one(_lay, in_axes=(None, 0, 0))


def lay(
    job: Job,
    grid: PaintGrid,
    driven: Driven,
    truth: Truth,
    *,
    colour: Int[np.ndarray, "worlds time"] | None = None,
    colours: int = 1,
) -> Laid:
    """Lays the paint of all worlds and scores how they tracked, in groups of worlds that fit into memory.

    colour: in hand at each record, from 0; None for one colour throughout. colours: how many there are.
    """
    hand = None if colours == 1 or colour is None else np.asarray(colour, np.int32)
    length = driven.record.pen.shape[1]
    log, padded_hand = jax.tree.map(
        lambda x: _padded(x, -(-length // LOG_ROWS) * LOG_ROWS), (log_of(driven, truth), hand)
    )
    window = window_cells(job.brush, float(grid.cell))
    layer = _Layer(job.scene.chart, job.brush, grid, job.dt * RECORD_EVERY, window, colours)

    def laid(worlds: Group):
        if len(worlds) == len(log.pen):
            return _LAY(layer, log, padded_hand)
        return _LAY(layer, *jax.tree.map(lambda x: x[worlds], (log, padded_hand)))

    worlds, shape = len(log.pen), (colours, *grid.shape)
    groups = split(worlds, int(np.prod(shape)) * grid.cell.dtype.itemsize)
    if len(groups) == 1:
        thickness, stray, uv, tracking = laid(groups[0])
        films = Films((worlds, *shape), groups, lambda part: laid(part)[0], thickness)
        return Laid(films, stray, uv[:, :length], tracking, hand)
    stray, uv, tracking = _without_films(laid, groups)
    films = Films((worlds, *shape), groups, lambda part: laid(part)[0])
    return Laid(films, stray, uv[:, :length], tracking, hand)


def paint_scores(
    wanted: Wanted, grid: PaintGrid, laid: Laid, down: Bool[np.ndarray, "worlds time"], *, film: float
) -> list[PaintScore]:
    """Scores the paint of all worlds, as many at a time as fit into memory.

    down: whether the brush's place counts: live and pen down. film: nominal [m].
    """
    uv, stray = np.asarray(laid.uv), np.asarray(laid.stray)
    scores = []
    for worlds, films in laid.films.groups():
        hand = None if laid.colour is None else laid.colour[worlds]
        swept = uv[worlds], down[worlds]
        scores += score_paint_worlds(wanted, grid, films, *swept, film=film, stray=stray[worlds], colour=hand)
    return scores


def log_of(driven: Driven, truth: Truth) -> Log:
    """What all worlds recorded, beside the truth."""
    record = driven.record
    return Log(
        planned=record.planned,
        brush=truth.position,  # pyright: ignore[reportArgumentType]
        axis=truth.axis,  # pyright: ignore[reportArgumentType]
        pen=record.pen,
        live=record.live,
        odometry=record.odometry,
        base=record.base,
        halted=record.halted > 0.5,
    )


def _without_films(laid: Callable, groups: tuple[Group, ...]):
    """What laying gives besides films, of all groups, every world once."""
    parts, seen = [], 0
    for worlds in groups:
        new = worlds >= seen
        seen = int(worlds[-1]) + 1
        parts.append(jax.tree.map(lambda x, new=new: np.asarray(x)[new], laid(worlds)[1:]))
    return jax.tree.map(lambda *x: np.concatenate(x), *parts)


def _padded(rows: np.ndarray, length: int) -> np.ndarray:
    """Repeats the last row; padding is not live."""
    missing = length - rows.shape[1]
    tail = np.repeat(rows[:, -1:], missing, axis=1)
    return np.concatenate([rows, np.zeros_like(tail) if rows.dtype == bool else tail], axis=1)


def completed_and_fault(driven: Driven) -> tuple[np.ndarray, Bool[np.ndarray, " worlds"]]:
    """Which worlds came to the end of their plan, and which did not for lack of a solution."""
    steps = np.maximum(np.asarray(driven.state.steps), 1)
    return driven.completed, ~driven.completed & (np.asarray(driven.state.faults) > 0.01 * steps)
