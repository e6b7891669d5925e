"""One painting run in a group of worlds: scan, map, decide, move, lay paint, score."""

import time
from collections.abc import Callable
from typing import NamedTuple, cast

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from jaxpaint.compiling import Batched, batched, one_by_one
from sims.paint import PaintGrid
from sims.painting.approach import Approach, approach, body_is_clear
from sims.painting.convert import brush_for_joints, ideal_run, joints_of
from sims.painting.decide import Chooser, choose_for_scan, choose_for_strokes
from sims.painting.drive import BrushPlan, Driven, JointPlan, drive
from sims.painting.job import APPROACH, PAINT, SCAN, Job
from sims.painting.lay import Laid, Truth, completed_and_fault, lay, true_brush
from sims.painting.path import Painting, plan_painting
from sims.painting.scan import ScanPlan, scan_motion, see, start_worlds
from sims.painting.tools import in_hand
from sims.rollout import Record
from sims.scoring import Chamfer, judge
from sims.scoring.true_surface import chamfer_to_chart
from sims.worlds import World

# What a mission spends its time on, with rough shares for a progress bar.
STAGES = {"scan": 0.1, "see": 0.15, "map": 0.15, "approach": 0.05, "paint": 0.45, "lay": 0.1}


class Modes(NamedTuple):
    """Whether the whole-body controller moved the robot through the viewpoints, and along the strokes."""

    scan: np.ndarray
    paint: np.ndarray


class Mission(NamedTuple):
    """All that happened in one group; array leaves have a leading worlds axis.

    status: `sims.status.Status` of each world. clouds: scanned, with which points are real. executed_s: wall
    time of the execution, paint included, compilation not.
    """

    status: np.ndarray
    modes: Modes
    clouds: tuple[Float[Array, "worlds n 3"], Array]
    painting: Painting
    driven: Driven
    truth: Truth
    laid: Laid
    surface: Chamfer
    executed_s: float


def run_mission(
    job: Job,
    grid: PaintGrid,
    index: Int[np.ndarray, " worlds"],
    *,
    controller: Chooser = "acp",
    advance: Callable[[float], None] = lambda share: None,
    disturb: Callable[[World], World] = lambda worlds: worlds,
) -> Mission:
    """Runs the worlds of those indices. advance: told the share of the work that was done. disturb: changes
    the worlds before they start (tests inject failures with it).
    """
    worlds = disturb(start_worlds(job, index))
    scan, driven, scan_mode = _scan(job, worlds, index, controller, advance)
    clouds = see(job, scan, driven, index)
    advance(STAGES["see"])
    painting = plan_painting(job, *clouds)
    paint_mode = choose_for_strokes(controller, job, painting.path)
    advance(STAGES["map"])
    path_there, arrived = _approach(job, driven.state.world, painting, index)
    diverged = driven.diverged | arrived.diverged
    advance(STAGES["approach"])
    jax.block_until_ready(painting)
    begin = time.perf_counter() - Batched.spent_s
    driven, colour = _paint(job, painting, arrived.state.world, index, paint_mode, advance)
    truth = true_brush(job, driven)
    laid = jax.block_until_ready(lay(job, grid, driven, truth, colour=colour, colours=job.colours))
    executed = time.perf_counter() - Batched.spent_s - begin
    reachable = (
        np.asarray(scan.reachable & path_there.reachable)
        & body_is_clear(scan.gap)
        & body_is_clear(path_there.gap)
    )
    status = _judge(driven, laid, reachable, diverged | driven.diverged)
    surface = _CHAMFER(job.scene.chart, *clouds, *_extent(grid))
    advance(STAGES["lay"])
    return Mission(
        status, Modes(scan_mode, paint_mode), clouds, painting, driven, truth, laid, surface, executed
    )


def _scan(
    job: Job, worlds: World, index, controller: Chooser, advance
) -> tuple[ScanPlan, Driven, np.ndarray]:
    scan = scan_motion(job, worlds)
    mode = choose_for_scan(controller, job, len(index))
    plans = (lambda: scan.plan), (lambda: brush_for_joints(job, scan.plan))
    driven = _by_mode(job, mode, plans, worlds, index, SCAN, lambda share: advance(share * STAGES["scan"]))
    return scan, driven, mode


def _approach(job: Job, worlds: World, painting: Painting, index) -> tuple[Approach, Driven]:
    """The first stroke's pose is an independent waypoint: the trajectory controller goes there."""
    plan = approach(job, worlds, painting)
    return plan, drive(job, plan.plan, worlds, jnp.asarray(index, jnp.int32), APPROACH)


def _paint(job: Job, painting: Painting, worlds: World, index, mode: np.ndarray, advance):
    """The execution, and the colour in hand at each record."""
    numbers = jnp.asarray(index, jnp.int32)
    ideal = None if mode.all() else ideal_run(job, painting.plan, worlds, numbers)
    plans = (lambda: joints_of(job, cast(Record, ideal))), (lambda: painting.plan)
    driven = _by_mode(job, mode, plans, worlds, index, PAINT, lambda share: advance(share * STAGES["paint"]))
    return driven, in_hand(job, painting, np.asarray(driven.record.clock), mode, ideal)


def _by_mode(
    job: Job,
    whole_body: np.ndarray,
    plans: tuple[Callable[[], JointPlan | BrushPlan], Callable[[], JointPlan | BrushPlan]],
    worlds: World,
    index,
    purpose: int,
    advance: Callable[[float], None],
) -> Driven:
    """Every world under the controller that was chosen for it; usually it is one for all."""
    numbers = jnp.asarray(index, jnp.int32)
    if whole_body.all() or not whole_body.any():
        return drive(job, plans[int(whole_body.all())](), worlds, numbers, purpose, advance)
    by_trajectory = drive(job, plans[0](), worlds, numbers, purpose, lambda share: advance(share / 2))
    by_whole_body = drive(job, plans[1](), worlds, numbers, purpose, lambda share: advance(share / 2))
    return _merged(whole_body, by_trajectory, by_whole_body)


def _merged(second: np.ndarray, a: Driven, b: Driven) -> Driven:
    """Worlds of `b` where `second`, else of `a`; the shorter record is padded with rows that are not live.

    The controllers' memories differ in kind and are dropped.
    """
    length = max(a.record.pen.shape[1], b.record.pen.shape[1])

    def pick(x, y):
        x, y = np.asarray(x), np.asarray(y)
        return np.where(second.reshape(-1, *[1] * (x.ndim - 1)), y, x)

    def longer(record):
        return jax.tree.map(lambda x: _with_tail(np.asarray(x), length), record)

    state_a, state_b = (d.state.__class__(**{**vars(d.state), "memory": ()}) for d in (a, b))
    state = jax.tree.map(pick, state_a, state_b)
    record = jax.tree.map(pick, longer(a.record), longer(b.record))
    ends = (np.where(second, y, x) for x, y in ((a.completed, b.completed), (a.diverged, b.diverged)))
    return Driven(state, record, *ends)


def _with_tail(rows: np.ndarray, length: int) -> np.ndarray:
    tail = np.repeat(rows[:, -1:], length - rows.shape[1], axis=1)
    return np.concatenate([rows, np.zeros_like(tail) if rows.dtype == bool else tail], axis=1)


def _judge(driven: Driven, laid: Laid, reachable: np.ndarray, diverged: np.ndarray) -> np.ndarray:
    completed, fault = completed_and_fault(driven)
    score = laid.tracking
    score = score.__class__(**{**vars(score), "finite": np.asarray(score.finite) & ~diverged})
    unreachable = ~reachable | np.asarray(driven.state.gave_up)
    return np.asarray(_JUDGE(score, jnp.asarray(completed), jnp.asarray(unreachable), jnp.asarray(fault)))


_JUDGE = batched(
    lambda score, completed, unreachable, infeasible: judge(
        score, completed=completed, unreachable=unreachable, infeasible=infeasible
    ),
    in_axes=(0, 0, 0, 0),
)
_CHAMFER = one_by_one(chamfer_to_chart, in_axes=(None, 0, 0, None, None))


def _extent(grid: PaintGrid):
    rows, columns = grid.shape
    low = grid.origin - grid.cell / 2
    return low, low + grid.cell * jnp.asarray([columns, rows], low.dtype)
