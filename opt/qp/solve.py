"""Solves a program and differentiates its solution through the optimality conditions."""

from typing import Any, cast

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from opt.qp import ldl
from opt.qp.interior_point import Iterate, iterate, kkt_solve, residuals
from opt.qp.problem import QPSolution, QPStatus, QuadraticProgram, is_finite

# Bounds nearer than this [unit of x] are moved apart for the iteration: it needs an inside.
_LEAST_WIDTH = 1e-5
# The complementarity that counts as zero, by precision.
_SHARP = {"float32": 1e-9, "float64": 1e-14}
_TOLERANCE = {"float32": 1e-3, "float64": 1e-7}


def solve_qp(
    problem: QuadraticProgram, *, smoothing: float | Array = 0.0, iterations: int = 12
) -> QPSolution:
    """Solves one program in a fixed number of iterations.

    smoothing: the product of bound distance and multiplier at the solution. At 0 (and below float precision)
    the solution is exact and its gradient jumps where a bound becomes active; above it the solution is the
    point of the central path, smooth everywhere. Gradients, forward and reverse, are those of the smoothed
    conditions, by implicit differentiation, so they cost one more small solve.
    """
    finite = is_finite(problem)
    ordered = (problem.lower <= problem.upper).all()
    usable = jax.tree.map(lambda a, b: jnp.where(finite, a, b), problem, _blank(problem))
    dtype = problem.target.dtype.name
    target = jnp.maximum(jnp.asarray(smoothing, problem.target.dtype), _SHARP[dtype])
    x, dual, residual = _central(_with_inside(usable), target, iterations)
    low, high = jnp.minimum(usable.lower, usable.upper), jnp.maximum(usable.lower, usable.upper)
    status = jnp.where(residual <= _TOLERANCE[dtype], QPStatus.SOLVED, QPStatus.NOT_CONVERGED)
    status = jnp.where(ordered, status, QPStatus.INFEASIBLE)
    status = jnp.where(finite, status, QPStatus.NOT_FINITE)
    return QPSolution(jnp.clip(x, low, high), dual, residual, status)


def _blank(problem: QuadraticProgram) -> QuadraticProgram:
    """A program with the solution zero, put in place of one that is not finite."""
    zero = jax.tree.map(jnp.zeros_like, problem)
    return QuadraticProgram(
        zero.cost + 1,
        zero.linear,
        zero.jacobian,
        zero.target,
        zero.slack_cost + 1,
        zero.lower - 1,
        zero.upper + 1,
    )


def _with_inside(problem: QuadraticProgram) -> QuadraticProgram:
    middle = (problem.lower + problem.upper) / 2
    half = jnp.maximum((problem.upper - problem.lower) / 2, _LEAST_WIDTH / 2)
    return QuadraticProgram(
        problem.cost,
        problem.linear,
        problem.jacobian,
        problem.target,
        problem.slack_cost,
        middle - half,
        middle + half,
    )


def _central(problem: QuadraticProgram, smoothing: Float[Array, ""], iterations: int):
    """x, y and the residual, with the derivative of the central path's conditions attached."""

    @jax.custom_jvp
    def point(problem, smoothing):
        final = iterate(problem, smoothing, iterations)
        return final.x, final.dual_task, _worst(problem, final, smoothing)

    @point.defjvp
    def _(primals, tangents):
        problem, smoothing = primals
        final = iterate(problem, smoothing, iterations)
        dx, dy = _differentiate(problem, final, cast(Any, tangents[0]), tangents[1])
        residual = _worst(problem, final, smoothing)
        return (final.x, final.dual_task, residual), (dx, dy, jnp.zeros_like(residual))

    return point(problem, smoothing)


def _worst(problem: QuadraticProgram, point: Iterate, smoothing: Float[Array, ""]) -> Float[Array, ""]:
    stationarity, rows = residuals(problem, point)
    products = jnp.maximum(point.gap_upper * point.dual_upper, point.gap_lower * point.dual_lower)
    scale = 1 + jnp.abs(problem.jacobian * point.dual_task[:, None]).sum(0)
    return jnp.maximum(
        jnp.maximum((jnp.abs(stationarity) / scale).max(), jnp.abs(rows).max()), products.max() - smoothing
    )


def _differentiate(problem: QuadraticProgram, point: Iterate, change: QuadraticProgram, d_smoothing):
    """Change of x and y when problem and smoothing change: the linearised conditions, solved once.

    With W = 1 / (M + z_u/s_u + z_l/s_l):  dx/W + J'dy = g  and  J dx - dy/L = h.
    """
    ratio_upper, ratio_lower = point.dual_upper / point.gap_upper, point.dual_lower / point.gap_lower
    weight = 1 / (problem.cost + ratio_upper + ratio_lower)
    factors = ldl.factor(ldl.weighted_gram(problem.jacobian, weight, 1 / problem.slack_cost))
    g = -(change.cost * point.x + change.linear + (change.jacobian * point.dual_task[:, None]).sum(0))
    g = g + ratio_upper * change.upper + ratio_lower * change.lower
    g = g - d_smoothing / point.gap_upper + d_smoothing / point.gap_lower
    h = change.target - (change.jacobian * point.x).sum(1)
    h = h - point.dual_task * change.slack_cost / problem.slack_cost**2
    return kkt_solve(problem.jacobian, weight, factors, g, h)
