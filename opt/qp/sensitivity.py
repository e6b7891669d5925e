"""How a solution changes with its program: the linearised optimality conditions, solved once."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from opt.qp.iterate import Iterate, goal_of, joined, prepared, sides
from opt.qp.newton import newton_system
from opt.qp.problem import QuadraticProgram


def change_of_solution(
    problem: QuadraticProgram,
    point: Iterate,
    smoothing: Float[Array, ""],
    change: QuadraticProgram,
    d_smoothing: Float[Array, ""],
) -> tuple[Array, Array, Array, Array]:
    """Change of x and of the multipliers (bounds, task rows, inequality rows) with program and smoothing."""
    task = prepared(problem)
    goal = goal_of(task, point.relaxed, smoothing)
    side, m = sides(point.x), problem.target.shape[0]
    ratio = point.dual / point.gap
    diagonal = joined(goal.compliance[:m], goal.compliance[m:] + point.gap_rows / point.dual_rows)
    system = newton_system(goal.hessian, ratio[0] + ratio[1], task.rows, diagonal, 0.0)
    along = change.hessian * point.x if problem.hessian.ndim == 1 else (change.hessian * point.x).sum(1)
    # Change of each bound's multiplier while x stands still.
    d_bounds = ratio * side * jnp.stack([change.upper, change.lower]) + d_smoothing / point.gap
    g = d_bounds[1] - d_bounds[0] - goal.keep * (along + change.linear)
    g = (
        g
        - (change.jacobian * point.dual_task[:, None]).sum(0)
        - (change.rows * point.dual_rows[:, None]).sum(0)
    )
    h_task = (
        change.target - (change.jacobian * point.x).sum(1) + goal.keep * change.compliance * point.dual_task
    )
    h_rows = change.limit - (change.rows * point.x).sum(1) - d_smoothing / point.dual_rows
    dx, dual = system.solve(g, joined(h_task, h_rows))
    return dx, d_bounds - ratio * side * dx, dual[:m], dual[m:]
