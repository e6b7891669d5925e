"""Solves a program and differentiates its solution through the optimality conditions."""

from typing import Any, cast

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jax.ad_checkpoint import checkpoint_name
from jaxtyping import Array, Bool, Float

from opt.qp.interior_point import solve_path
from opt.qp.iterate import Iterate, Start
from opt.qp.problem import Duals, QPSolution, QPStatus, QuadraticProgram, Residuals, is_convex
from opt.qp.sensitivity import change_of_solution

SOLUTION = "solution of a quadratic program"
"""What `jax.checkpoint` policies call the last iterate."""

# Bounds nearer than this [unit of x] are moved apart for the iteration: it needs an inside.
_LEAST_WIDTH = 1e-6
# Bounds further than this [unit of x] count as this far: an iteration cannot work with infinity.
_FAR = 1e6


def solve_qp(
    problem: QuadraticProgram,
    *,
    smoothing: float | Array = 0.0,
    iterations: int = 25,
    fixed: bool = False,
    start: QPSolution | None = None,
) -> QPSolution:
    """Solves one program in at most `iterations` steps; most need 7 or 8.

    smoothing: the product of bound distance and multiplier at the solution. At 0 (and below float precision)
    the solution is exact and its gradient jumps where a bound becomes active; above it the solution is the
    point of the central path, smooth everywhere. Gradients, forward and reverse, are those of the smoothed
    conditions, by implicit differentiation, so they cost one more small solve.

    A program whose hard rows and bounds contradict each other gets the x of the least violation (the root of
    the summed squares of Jx - v and of what Ax exceeds b) and the status INFEASIBLE; the search for it begins
    anew, with as many iterations. fixed: makes exactly `iterations` steps and looks at the last alone: for
    programs inside of a loop, above all those whose rows are all soft. An infeasible program is recognised
    then too, but its value is not the least violation. start: the solution of a program like this one, from
    where it takes fewer steps; where it leads nowhere, the search begins anew without it.

    Raises ValueError where both fixed and start are given: there is no room to begin anew.
    """
    if fixed and start is not None:
        raise ValueError("start: found together with fixed=True, allowed: with fixed=False")
    ordered, inner = (problem.lower <= problem.upper).all(), _with_inside(problem)
    target = jnp.asarray(smoothing, problem.linear.dtype)
    first = None if start is None else jax.lax.stop_gradient(Start(start.value, start.dual))
    point = _central(inner, first, target, iterations, fixed)
    usable = point.usable & jnp.isfinite(target) & jnp.isfinite(point.x).all()
    low, high = jnp.minimum(problem.lower, problem.upper), jnp.maximum(problem.lower, problem.upper)
    solved = point.done & (point.relaxed == 0)
    status = jnp.where(solved, QPStatus.SOLVED, QPStatus.NOT_CONVERGED)
    status = jnp.where((solved | ~point.proven) & ordered, status, QPStatus.INFEASIBLE)
    point = point._replace(usable=usable)
    shown = jax.tree.map(lambda a: jnp.where(usable, a, jnp.zeros_like(a)), point)
    value = jnp.where(usable, jnp.clip(point.x, low, high), 0.0)
    status = jnp.where(solved & _far_out(value, problem), QPStatus.UNBOUNDED, status)
    status = jnp.where(usable, status, QPStatus.NOT_FINITE)
    status = jnp.where(is_convex(problem), status, QPStatus.NOT_CONVEX)
    dual = Duals(shown.dual_task, shown.dual_rows, shown.dual[1], shown.dual[0])
    return QPSolution(value, dual, _residuals(inner, point), point.count, status)


def _with_inside(problem: QuadraticProgram) -> QuadraticProgram:
    lower, upper = jnp.maximum(problem.lower, -_FAR), jnp.minimum(problem.upper, _FAR)
    middle, half = (lower + upper) / 2, jnp.maximum((upper - lower) / 2, _LEAST_WIDTH / 2)
    return eqx.tree_at(lambda p: (p.lower, p.upper), problem, (middle - half, middle + half))


def _far_out(value: Float[Array, "n"], problem: QuadraticProgram) -> Bool[Array, ""]:
    """Whether nothing but the stand-in for an infinite bound holds the value."""
    above = (value > _FAR / 2) & (problem.upper > _FAR)
    return (above | (value < -_FAR / 2) & (problem.lower < -_FAR)).any()


def _central(
    problem: QuadraticProgram, start: Start | None, smoothing: Float[Array, ""], iterations: int, fixed: bool
) -> Iterate:
    """The last iterate; x and the multipliers carry the derivative of the central path's conditions."""

    @jax.custom_jvp
    def solution(problem, start, smoothing):
        return solve_path(problem, start, smoothing, iterations, fixed)

    @solution.defjvp
    def _(primals, tangents):
        problem, start, smoothing = primals
        # By its name a `jax.checkpoint` may keep it: to solve again costs more than all else of a step.
        point = jax.tree.map(lambda x: checkpoint_name(x, SOLUTION), solution(problem, start, smoothing))
        change, d_smoothing = cast(Any, tangents[0]), tangents[2]
        # What is not finite gets no derivative, rather than one that is NaN.
        tame, base, change, d_smoothing = jax.tree.map(
            lambda a, b: jnp.where(point.usable, a, b),
            (problem, point, change, d_smoothing),
            (_blank(problem), jax.tree.map(jnp.ones_like, point), *_zeros((change, d_smoothing))),
        )
        x, dual, task, rows = change_of_solution(tame, base, smoothing, change, d_smoothing)
        still = jax.tree.map(_no_tangent, point)
        return point, still._replace(x=x, dual=dual, dual_task=task, dual_rows=rows)

    return solution(problem, start, smoothing)


def _zeros(tree):
    return jax.tree.map(jnp.zeros_like, tree)


def _blank(problem: QuadraticProgram) -> QuadraticProgram:
    """Ones and zeros, put in place of a program that is not finite."""
    zero = _zeros(problem)
    whole = zero.hessian + (1 if problem.hessian.ndim == 1 else jnp.eye(problem.linear.shape[0]))
    return eqx.tree_at(lambda p: (p.hessian, p.compliance), zero, (whole, zero.compliance + 1))


def _no_tangent(x: Array):
    """Zero as the tangent of what carries no derivative; whole numbers and flags have a type of their own."""
    if jnp.issubdtype(x.dtype, jnp.floating):
        return jnp.zeros_like(x)
    return np.zeros(x.shape, jax.dtypes.float0)


def _residuals(problem: QuadraticProgram, point: Iterate) -> Residuals:
    """How far the conditions of the given program are from being met, whatever the iterate worked on."""
    problem, point = jax.lax.stop_gradient((problem, point))
    along = problem.hessian * point.x if problem.hessian.ndim == 1 else (problem.hessian * point.x).sum(1)
    pull = (problem.jacobian * point.dual_task[:, None]).sum(0) + (
        problem.rows * point.dual_rows[:, None]
    ).sum(0)
    stationarity = along + problem.linear + pull + point.dual[0] - point.dual[1]
    rows = (problem.jacobian * point.x).sum(1) - problem.compliance * point.dual_task - problem.target
    over = jnp.maximum((problem.rows * point.x).sum(1) - problem.limit, 0.0)
    products = (point.gap * point.dual).max(), (point.gap_rows * point.dual_rows).max(initial=0.0)
    found = Residuals(
        jnp.abs(stationarity).max(),
        jnp.abs(rows).max(initial=0.0),
        over.max(initial=0.0),
        jnp.maximum(*products),
    )
    return jax.tree.map(lambda a: jnp.where(point.usable, a, jnp.inf), found)
