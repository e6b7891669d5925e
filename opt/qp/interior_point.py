"""A primal-dual interior point with a fixed number of Mehrotra predictor-corrector steps."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from opt.qp import ldl
from opt.qp.problem import QuadraticProgram

# Share of the way to the nearest bound that a step may go.
_TO_BOUND = 0.99


class Iterate(NamedTuple):
    """x, distances to the upper and lower bounds, their multipliers, and the task rows' multiplier."""

    x: Float[Array, "n"]
    gap_upper: Float[Array, "n"]
    gap_lower: Float[Array, "n"]
    dual_upper: Float[Array, "n"]
    dual_lower: Float[Array, "n"]
    dual_task: Float[Array, "m"]


class Direction(NamedTuple):
    """A Newton direction of `Iterate`; the gaps move with x."""

    x: Array
    dual_upper: Array
    dual_lower: Array
    dual_task: Array


def iterate(problem: QuadraticProgram, smoothing: Float[Array, ""], iterations: int) -> Iterate:
    """The iterate after `iterations` steps towards complementarity `smoothing` (gap times multiplier)."""

    def step(_, point: Iterate) -> Iterate:
        return _step(problem, point, smoothing)

    return jax.lax.fori_loop(0, iterations, step, _start(problem))


def _start(problem: QuadraticProgram) -> Iterate:
    middle = (problem.lower + problem.upper) / 2
    dual = jnp.full_like(middle, 0.1)
    return Iterate(
        middle, problem.upper - middle, middle - problem.lower, dual, dual, jnp.zeros_like(problem.target)
    )


def _step(problem: QuadraticProgram, point: Iterate, smoothing: Float[Array, ""]) -> Iterate:
    """One predictor-corrector step; both directions share one factorisation of J W J' + 1/L."""
    count = 2 * point.x.shape[0]
    curvature = point.dual_upper / point.gap_upper + point.dual_lower / point.gap_lower
    weight = 1 / (problem.cost + curvature)
    factors = ldl.factor(ldl.weighted_gram(problem.jacobian, weight, 1 / problem.slack_cost))
    dual_residual, task_residual = residuals(problem, point)
    mean = (point.gap_upper * point.dual_upper + point.gap_lower * point.dual_lower).sum() / count

    def direction(target_upper, target_lower) -> Direction:
        """Newton direction when the products gap * multiplier are to become the targets."""
        upper, lower = target_upper / point.gap_upper, target_lower / point.gap_lower
        gradient = dual_residual - point.dual_upper + point.dual_lower + upper - lower
        dx, dy = kkt_solve(problem.jacobian, weight, factors, -gradient, -task_residual)
        d_upper = upper - point.dual_upper + point.dual_upper / point.gap_upper * dx
        d_lower = lower - point.dual_lower - point.dual_lower / point.gap_lower * dx
        return Direction(dx, d_upper, d_lower, dy)

    zero = jnp.zeros_like(point.x)
    guess = direction(zero, zero)
    ahead = _advance(point, guess, jnp.minimum(_longest(point, guess), 1.0))
    mean_ahead = (ahead.gap_upper * ahead.dual_upper + ahead.gap_lower * ahead.dual_lower).sum() / count
    target = jnp.maximum(mean * (mean_ahead / mean) ** 3, smoothing)
    # On the central path itself the predictor's curvature is no error: without this the end would miss it.
    bend = jnp.maximum(1 - smoothing / mean, 0.0) * guess.x
    final = direction(target + bend * guess.dual_upper, target - bend * guess.dual_lower)
    return _advance(point, final, jnp.minimum(_TO_BOUND * _longest(point, final), 1.0))


def residuals(problem: QuadraticProgram, point: Iterate) -> tuple[Float[Array, "n"], Float[Array, "m"]]:
    """Stationarity in x, and the task rows J x - y / L - v."""
    by_rows = (problem.jacobian * point.dual_task[:, None]).sum(0)
    stationarity = problem.cost * point.x + problem.linear + by_rows + point.dual_upper - point.dual_lower
    rows = (problem.jacobian * point.x).sum(1) - point.dual_task / problem.slack_cost - problem.target
    return stationarity, rows


def kkt_solve(
    jacobian: Float[Array, "m n"], weight: Float[Array, "n"], factors: ldl.LDL, right_x, right_rows
) -> tuple[Float[Array, "n"], Float[Array, "m"]]:
    """Solves diag(1/weight) dx + J'dy = right_x, J dx - dy/L = right_rows by the Schur complement."""
    weighted = weight * right_x
    dy = ldl.solve(factors, (jacobian * weighted).sum(1) - right_rows)
    return weighted - weight * (jacobian * dy[:, None]).sum(0), dy


def _longest(point: Iterate, d: Direction) -> Float[Array, ""]:
    """The step at which the first gap or multiplier would reach zero."""
    shrink = jnp.stack(
        [
            d.x / point.gap_upper,
            -d.x / point.gap_lower,
            -d.dual_upper / point.dual_upper,
            -d.dual_lower / point.dual_lower,
        ]
    )
    return 1 / jnp.maximum(shrink.max(), 1e-3)


def _advance(point: Iterate, d: Direction, length: Float[Array, ""]) -> Iterate:
    return Iterate(
        point.x + length * d.x,
        point.gap_upper - length * d.x,
        point.gap_lower + length * d.x,
        point.dual_upper + length * d.dual_upper,
        point.dual_lower + length * d.dual_lower,
        point.dual_task + length * d.dual_task,
    )
