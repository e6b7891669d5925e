"""A primal-dual interior point, for programs with and without a solution."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from opt.qp.feasibility import proves_infeasible
from opt.qp.iterate import Goal, Iterate, Start, Task, cold, given, goal_of, joined, prepared, warm
from opt.qp.problem import QuadraticProgram, is_convex, is_finite
from opt.qp.step import step

# So many steps are made before an iterate is looked at, from a cold and from a warm start: nearly all
# programs need about as many, and to look costs as much as a step. With inequality rows it is one more.
_BLIND = 9
_BLIND_WARM = 6
# After so many more steps those that go on are gathered anew: slow ones then hold up no others.
_ROUND = 3
# Relative residual at which an iteration ends, by precision.
_TOLERANCE = {"float32": 1e-5, "float64": 1e-13}


def solve_path(
    problem: QuadraticProgram,
    start: Start | None,
    smoothing: Float[Array, ""],
    iterations: int,
    fixed: bool,
) -> Iterate:
    """The last iterate towards complementarity `smoothing`, after at most `iterations` steps from each start.

    A world that is done keeps its iterate while its neighbours go on: its result does not depend on them.
    """
    # A function of its own under jit: `jaxpaint.compiling` takes it block by block.
    blind = jax.jit(_blind_steps, static_argnums=3)
    steps = (_BLIND if start is None else _BLIND_WARM) + (problem.limit.shape[0] > 0)
    count = iterations if fixed else min(iterations, steps)
    point = blind(problem, start, smoothing, count)
    if fixed:
        return point

    def finish(point: Iterate) -> Iterate:
        return _judged_steps(problem, point, smoothing, iterations, start is not None)

    return jax.lax.while_loop(lambda point: ~point.over, finish, point)


def _blind_steps(
    problem: QuadraticProgram, start: Start | None, smoothing: Float[Array, ""], count: int
) -> Iterate:
    """So many steps; what is over is only looked at after the last."""
    task = prepared(problem)
    goal = given(task, smoothing)
    first = cold(task, goal, jnp.zeros_like(smoothing)) if start is None else warm(task, goal, start)
    point = jax.lax.fori_loop(0, count, lambda _, point: step(task, goal, point), first)
    done = _converged(task, goal, point, smoothing)
    usable = is_finite(problem) & is_convex(problem)
    return point._replace(
        usable=usable,
        count=jnp.full_like(point.count, count),
        done=done,
        over=done | ~usable,
        proven=proves_infeasible(problem, point.dual_task, point.dual_rows),
    )


def _judged_steps(
    problem: QuadraticProgram, point: Iterate, smoothing: Float[Array, ""], iterations: int, warmed: bool
) -> Iterate:
    """The steps that are left, each iterate looked at. Where one proves that no x meets the rows, or steps
    run out, the search for the least violation begins, which finds the proof if there is one. warmed: the
    steps so far came from a warm start, and count for nothing unless they ended it.
    """
    task = prepared(problem)
    one, hard = jnp.ones_like(smoothing), (task.compliance == 0).any()
    anew = cold(task, goal_of(task, one, smoothing), one)

    def begun(point: Iterate, start: Iterate, where: Bool[Array, ""]) -> Iterate:
        kept = ("count", "proven", "usable")
        start = start._replace(begun=point.count, **{name: getattr(point, name) for name in kept})
        return jax.tree.map(lambda a, b: jnp.where(where, a, b), start, point)

    def left(point: Iterate) -> Bool[Array, ""]:
        return point.count - point.begun < iterations

    def relaxing(point: Iterate) -> Iterate:
        return begun(point, anew, hard & ~point.done & (point.relaxed == 0) & (point.proven | ~left(point)))

    def judged_step(point: Iterate) -> Iterate:
        goal = goal_of(task, point.relaxed, smoothing)
        point = step(task, goal, point)
        proven = point.proven | proves_infeasible(problem, point.dual_task, point.dual_rows)
        done = _converged(task, goal, point, smoothing)
        return relaxing(point._replace(count=point.count + 1, done=done, proven=proven))

    if warmed:
        anew_at_first = (point.begun == 0) & ~point.done & ~point.proven
        point = begun(point, cold(task, given(task, smoothing), 0 * one), anew_at_first)
    end = point.count + _ROUND
    point = jax.lax.while_loop(
        lambda point: ~point.done & left(point) & (point.count < end), judged_step, relaxing(point)
    )
    return point._replace(over=point.done | ~left(point))


def _converged(task: Task, goal: Goal, point: Iterate, smoothing: Float[Array, ""]) -> Bool[Array, ""]:
    tolerance = _TOLERANCE[task.rows.dtype.name]
    dual = jnp.abs(joined(point.dual_task, point.dual_rows))
    # The least violation may be small beside the gradients that a step can meet on its way.
    size = goal.keep * goal.gradient_size + (task.row_size * dual).max(initial=0.0)
    flat = jnp.abs(point.stationarity).max() <= tolerance * size
    met = jnp.abs(point.misses).max(initial=0.0) <= tolerance * (1e-3 + task.right_size)
    # A central path that was asked for is met exactly; products that count as zero only have to be small.
    off = jnp.abs(point.gap * point.dual - goal.target)
    off_rows = jnp.abs(point.gap_rows * point.dual_rows - goal.target)
    off = jnp.maximum(jnp.maximum(off[0], off[1]).max(), off_rows.max(initial=0.0))
    return flat & met & (off <= jnp.where(smoothing > 0, 100 * tolerance, 1.0) * goal.target)
