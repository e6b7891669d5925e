"""The state of an iteration, and what every step needs of its program."""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from opt.qp.problem import Duals, QuadraticProgram

# Complementarity that counts as zero, as share of that at the start, by precision.
SHARP = {"float32": 1e-9, "float64": 1e-13}
# While the violation itself is minimised: weight of the steps' length, as share of the rows' own.
_STEP_WEIGHT = 1e-4
# Share of the box that a warm start keeps off the bounds, and of the products of a cold start that it has.
_OFF = 1e-2


class Start(NamedTuple):
    """Where to begin: value and multipliers of a program like this one."""

    value: Float[Array, "n"]
    dual: Duals


class Task(NamedTuple):
    """A program, and what every iteration needs of it: computed once.

    bounds: upper, then lower. rows: task rows and inequalities, right: their v and b, compliance: of both.
    row_size, right_size: the largest entry of each row, and of v and b. steepest: how large the gradient of
    the cost is, and that of half the squared violation. width: mean half width of the box, far bounds left
    out. step_weight: while the violation is minimised, weight of the steps' length beside it.
    """

    problem: QuadraticProgram
    bounds: Float[Array, "2 n"]
    rows: Float[Array, "r n"]
    right: Float[Array, "r"]
    compliance: Float[Array, "r"]
    row_size: Float[Array, "r"]
    right_size: Float[Array, ""]
    steepest: tuple[Array, Array]
    width: Float[Array, ""]
    step_weight: Float[Array, ""]


class Goal(NamedTuple):
    """What a step works on: the given program, or that of the least violation.

    keep: 1 for the given one, 0 where cost is dropped. hessian includes the weight of the steps' length.
    gradient_size: of what is minimised. target: complementarity to be reached.
    """

    keep: Array | float
    hessian: Array
    compliance: Array
    gradient_size: Array
    target: Array


class Iterate(NamedTuple):
    """x, distances to the bounds and their multipliers (upper, then lower), multipliers of the task rows, and
    distances and multipliers of the inequality rows.

    stationarity, misses: residuals there, see `with_residuals`. relaxed: 1 once no x meets all hard rows:
    from there on the violation alone is minimised. done: meets its conditions. proven: that no x meets all
    hard rows. over: nothing is left to do. usable: the program is finite and convex. count: steps so far, of
    which `begun` belong to earlier starts.
    """

    x: Float[Array, "n"]
    gap: Float[Array, "2 n"]
    dual: Float[Array, "2 n"]
    dual_task: Float[Array, "m"]
    gap_rows: Float[Array, "k"]
    dual_rows: Float[Array, "k"]
    stationarity: Float[Array, "n"]
    misses: Float[Array, "r"]
    relaxed: Float[Array, ""]
    count: Int[Array, ""]
    begun: Int[Array, ""]
    done: Bool[Array, ""]
    proven: Bool[Array, ""]
    over: Bool[Array, ""]
    usable: Bool[Array, ""]


def sides(like: Array) -> Float[Array, "2 1"]:
    """How the distances to upper and lower bound change with x."""
    return jnp.asarray([[-1.0], [1.0]], like.dtype)


def joined(first: Array, second: Array) -> Array:
    """One behind the other; nothing is copied where there is only one."""
    return first if second.shape[0] == 0 else jnp.concatenate([first, second])


def prepared(problem: QuadraticProgram) -> Task:
    """A program with its sizes."""
    half = jnp.minimum((problem.upper - problem.lower) / 2, 1.0)
    diagonal = problem.hessian if problem.hessian.ndim == 1 else jnp.diagonal(problem.hessian)
    rows, right = joined(problem.jacobian, problem.rows), joined(problem.target, problem.limit)
    row_size = jnp.abs(rows).max(axis=1)
    far = jnp.abs(rows * half).sum(1).max(initial=0.0) / 10
    cost = jnp.abs(problem.linear).max() + (diagonal * half).max() + _pull(problem)
    # Where nothing but rows is asked for, the scale is that of multipliers that are no larger than one.
    cost = jnp.where(cost > 0, cost, jnp.maximum(row_size.max(initial=0.0), 1e-6))
    return Task(
        problem,
        jnp.stack([problem.upper, problem.lower]),
        rows,
        right,
        joined(problem.compliance, jnp.zeros_like(problem.limit)),
        row_size,
        jnp.abs(right).max(initial=0.0),
        (cost, row_size.max(initial=0.0) * far),
        half.mean(),
        _STEP_WEIGHT * (rows * rows).sum(0).sum() / max(rows.shape[0], 1),
    )


def _pull(problem: QuadraticProgram) -> Float[Array, ""]:
    """How large the gradient of the soft rows' cost is at least, where bounds keep x from meeting them."""
    middle, half = (problem.upper + problem.lower) / 2, (problem.upper - problem.lower) / 2
    rows, soft = jnp.abs(problem.jacobian), problem.compliance > 0
    off = jnp.abs((problem.jacobian * middle).sum(1) - problem.target)
    missed = jnp.where(soft, jnp.maximum(off - (rows * half).sum(1), 0.0), 0.0)
    return (rows.max(axis=1) * missed / jnp.where(soft, problem.compliance, 1.0)).max(initial=0.0)


def given(task: Task, smoothing: Float[Array, ""]) -> Goal:
    """The goal that is the program itself."""
    size, sharp = task.steepest[0], SHARP[task.rows.dtype.name]
    target = jnp.maximum(smoothing, sharp * size * task.width)
    return Goal(1.0, task.problem.hessian, task.compliance, size, target)


def goal_of(task: Task, relaxed: Float[Array, ""], smoothing: Float[Array, ""]) -> Goal:
    """The goal of an iterate, relaxed or not."""
    problem, keep = task.problem, 1 - relaxed
    weight, size = relaxed * task.step_weight, jnp.where(relaxed > 0, task.steepest[1], task.steepest[0])
    lift = weight if problem.hessian.ndim == 1 else weight * jnp.eye(problem.linear.shape[0])
    target = jnp.maximum(keep * smoothing, SHARP[task.rows.dtype.name] * size * task.width)
    return Goal(keep, keep * problem.hessian + lift, keep * task.compliance + relaxed, size, target)


def cold(task: Task, goal: Goal, relaxed: Float[Array, ""]) -> Iterate:
    """The middle of the box, or the point of it nearest to zero where it is wide; all products equal."""
    problem = task.problem
    half = (problem.upper - problem.lower) / 2
    near = jnp.minimum(half, 1.0)
    x = jnp.clip(jnp.zeros_like(half), problem.lower + near, problem.upper - near)
    gap = sides(x) * (x - task.bounds)
    gap_rows = jnp.maximum(problem.limit - (problem.rows * x).sum(1), 0.1)
    size = goal.gradient_size * task.width
    return _begin(task, goal, relaxed, (x, gap, size / gap, jnp.zeros_like(problem.target)), gap_rows, size)


def warm(task: Task, goal: Goal, start: Start) -> Iterate:
    """Near an earlier solution, off its bounds by a share of the box; multipliers fit the distances."""
    problem = task.problem
    half = (problem.upper - problem.lower) / 2
    near = _OFF * jnp.minimum(half, 1.0)
    x = jnp.clip(start.value, problem.lower + near, problem.upper - near)
    gap = sides(x) * (x - task.bounds)
    gap_rows = jnp.maximum(problem.limit - (problem.rows * x).sum(1), _OFF)
    product = _OFF * goal.gradient_size * task.width
    dual = jnp.maximum(jnp.stack([start.dual.upper, start.dual.lower]), product / gap)
    point = _begin(task, goal, jnp.zeros_like(product), (x, gap, dual, start.dual.task), gap_rows, product)
    dual_rows = jnp.maximum(point.dual_rows, start.dual.rows)
    return with_residuals(task, goal, point._replace(dual_rows=dual_rows))


def _begin(task: Task, goal: Goal, relaxed, point, gap_rows, product) -> Iterate:
    zero = jnp.zeros((), jnp.int32)
    none = (jnp.zeros_like(point[0]), jnp.zeros_like(task.right))
    no = jnp.zeros((), bool)
    flags = (relaxed, zero, zero, no, no, no, ~no)
    x, gap, dual, dual_task = point
    begun = Iterate(x, gap, dual, dual_task, gap_rows, product / gap_rows, *none, *flags)
    return with_residuals(task, goal, begun)


def with_residuals(task: Task, goal: Goal, point: Iterate) -> Iterate:
    """The iterate with its stationarity in x, and its rows: J x - R y - v, then A x + gap - R z - b."""
    dual, hessian = joined(point.dual_task, point.dual_rows), task.problem.hessian
    along = hessian * point.x if hessian.ndim == 1 else (hessian * point.x).sum(1)
    stationarity = (
        goal.keep * (along + task.problem.linear)
        + (task.rows * dual[:, None]).sum(0)
        + (point.dual[0] - point.dual[1])
    )
    misses = (task.rows * point.x).sum(1) - goal.compliance * dual - task.right
    if point.gap_rows.shape[0]:
        misses = misses + jnp.concatenate([jnp.zeros_like(point.dual_task), point.gap_rows])
    return point._replace(stationarity=stationarity, misses=misses)
