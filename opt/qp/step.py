"""One step of Mehrotra's predictor and corrector; both directions share one factorisation."""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from opt.qp.iterate import Goal, Iterate, Task, sides, with_residuals
from opt.qp.newton import FoldedSystem, NewtonSystem, folded_system, newton_system

# Share of the way to the nearest bound that a step may go. Nearer, one case in thousands jams (measured).
_TO_BOUND = 0.99
# Share of the Schur complement's mean diagonal added to it, by precision.
_REGULAR = {"float32": 4e-7, "float64": 1e-12}


class Direction(NamedTuple):
    """A Newton direction of `Iterate`. gap: of the bounds, `sides` times x."""

    x: Array
    gap: Array
    dual: Array
    dual_task: Array
    gap_rows: Array
    dual_rows: Array


class Local(NamedTuple):
    """What both directions of a step share. near: 1 / gap, of the rows 1 / multiplier; ratio: multiplier
    times near, of the rows gap times near.
    """

    system: NewtonSystem | FoldedSystem
    near: Array
    ratio: Array
    near_rows: Array
    ratio_rows: Array


def step(task: Task, goal: Goal, point: Iterate) -> Iterate:
    """The iterate one step further."""
    count = point.gap.size + point.gap_rows.shape[0]
    local = _local(task, goal, point)
    mean = _total(point) / count
    guess = _direction(local, point, None)
    length = jnp.minimum(_longest(local, point, guess), 1.0)
    # A direction towards products of zero leaves of them, after this length:
    ahead = (1 - length) * mean + length * length * _total(guess) / count
    target = jnp.maximum(mean * (ahead / mean) ** 3, goal.target)
    # The predictor's curvature, as far as the predictor could go: whole, it jams one case in thousands. On
    # the central path itself it is no error.
    bend = jnp.maximum(1 - goal.target / mean, 0.0) * length
    bent, bent_rows = guess.gap * guess.dual, guess.gap_rows * guess.dual_rows
    final = _direction(local, point, (target - bend * bent, target - bend * bent_rows))
    length = jnp.minimum(_TO_BOUND * _longest(local, point, final), 1.0)
    return with_residuals(task, goal, _advance(point, final, length))


def _local(task: Task, goal: Goal, point: Iterate) -> Local:
    near, near_rows = 1 / point.gap, 1 / point.dual_rows
    ratio, ratio_rows = point.dual * near, point.gap_rows * near_rows
    diagonal = goal.compliance
    if ratio_rows.shape[0]:
        diagonal = diagonal + jnp.concatenate([jnp.zeros_like(point.dual_task), ratio_rows])
    regular = _REGULAR[task.rows.dtype.name]
    curvature, tasks = ratio[0] + ratio[1], point.dual_task.shape[0]
    if ratio_rows.shape[0] > point.x.shape[0]:
        system = folded_system(goal.hessian, curvature, task.rows, diagonal, tasks, regular)
    else:
        system = newton_system(goal.hessian, curvature, task.rows, diagonal, regular)
    return Local(system, near, ratio, near_rows, ratio_rows)


def _direction(local: Local, point: Iterate, targets: tuple[Array, Array] | None) -> Direction:
    """Newton direction when the products gap * multiplier are to become the targets; None stands for 0."""
    side, m = sides(point.x), point.dual_task.shape[0]
    # What is to go of multipliers, and of the rows' distances, while x stands still.
    excess, excess_rows = point.dual, point.gap_rows
    if targets is not None:
        excess, excess_rows = excess - targets[0] * local.near, excess_rows - targets[1] * local.near_rows
    gradient = point.stationarity - (excess[0] - excess[1])
    misses = point.misses
    if excess_rows.shape[0]:
        misses = misses - jnp.concatenate([jnp.zeros_like(point.dual_task), excess_rows])
    dx, dual = local.system.solve(-gradient, -misses)
    gap = side * dx
    return Direction(
        dx,
        gap,
        -(excess + local.ratio * gap),
        dual[:m],
        -(excess_rows + local.ratio_rows * dual[m:]),
        dual[m:],
    )


def _total(at: Iterate | Direction) -> Float[Array, ""]:
    """The sum of all products of distance and multiplier."""
    # Side by side: an array of them would be written and read again.
    total = (at.gap[0] * at.dual[0] + at.gap[1] * at.dual[1]).sum()
    return total + (at.gap_rows * at.dual_rows).sum() if at.gap_rows.shape[0] else total


def _longest(local: Local, point: Iterate, d: Direction) -> Float[Array, ""]:
    """The step at which the first gap or multiplier would reach zero; at most 1000."""
    upper, lower = (jnp.maximum(-d.gap[k] * local.near[k], -d.dual[k] / point.dual[k]) for k in range(2))
    fastest = jnp.maximum(jnp.maximum(upper, lower).max(), 1e-3)
    if d.gap_rows.shape[0]:
        rows = jnp.maximum(-d.gap_rows / point.gap_rows, -d.dual_rows * local.near_rows)
        fastest = jnp.maximum(fastest, rows.max())
    return 1 / fastest


def _advance(point: Iterate, d: Direction, length: Float[Array, ""]) -> Iterate:
    return point._replace(
        x=point.x + length * d.x,
        gap=point.gap + length * d.gap,
        dual=point.dual + length * d.dual,
        dual_task=point.dual_task + length * d.dual_task,
        gap_rows=point.gap_rows + length * d.gap_rows,
        dual_rows=point.dual_rows + length * d.dual_rows,
    )
