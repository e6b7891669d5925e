"""What is solved, and what comes back."""

from enum import IntEnum

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, ArrayLike, Bool, Float, Int


class QuadraticProgram(eqx.Module):
    """min over x, s of 1/2 x'Mx + c'x + 1/2 s'R^-1 s  subject to  Jx + s = v,  Ax <= b,  lower <= x <= upper.

    S1-(10) and (11), with the slack s on the task rows of S1's reference [26]. The slack is eliminated in
    closed form, s = -Ry with the rows' multiplier y, and costs nothing; a row whose compliance is 0 is a hard
    equality.

    hessian: M, its diagonal [n] or whole [n, n], positive semidefinite. linear: c. jacobian: J. target: v.
    compliance: diagonal of R, 0 or more. rows, limit: A and b. lower, upper: bounds, which may be infinite.
    """

    hessian: Float[Array, "n"] | Float[Array, "n n"]
    linear: Float[Array, "n"]
    jacobian: Float[Array, "m n"]
    target: Float[Array, "m"]
    compliance: Float[Array, "m"]
    rows: Float[Array, "k n"]
    limit: Float[Array, "k"]
    lower: Float[Array, "n"]
    upper: Float[Array, "n"]


class QPStatus(IntEnum):
    """How a solution ended."""

    SOLVED = 0
    INFEASIBLE = 1  # no x meets all hard rows and bounds; the value violates them least
    NOT_CONVERGED = 2  # a residual above the tolerance after the last iteration
    NOT_FINITE = 3  # NaN in the problem, or infinity outside its bounds; the value is zero
    NOT_CONVEX = 4  # a compliance below 0, or a diagonal M with such an entry; the value is zero
    UNBOUNDED = 5  # the cost falls without end where bounds are infinite; the value is some point out there


class Duals(eqx.Module):
    """Multipliers: of the task rows (either sign), of the inequality rows and bounds (0 or more)."""

    task: Float[Array, "m"]
    rows: Float[Array, "k"]
    lower: Float[Array, "n"]
    upper: Float[Array, "n"]


class Residuals(eqx.Module):
    """Largest violations: of stationarity (in units of c), of the task rows, of the inequality rows, and of
    complementarity (multiplier times distance).
    """

    stationarity: Float[Array, ""]
    task: Float[Array, ""]
    rows: Float[Array, ""]
    complementarity: Float[Array, ""]


class QPSolution(eqx.Module):
    """Value and statistics of one solved program.

    value: x, always finite and within the bounds (between them where they contradict each other). iterations:
    how many were made. status: a `QPStatus`.
    """

    value: Float[Array, "n"]
    dual: Duals
    residuals: Residuals
    iterations: Int[Array, ""]
    status: Int[Array, ""]


def quadratic_program(
    hessian: ArrayLike,
    linear: ArrayLike,
    *,
    jacobian: ArrayLike | tuple[()] = (),
    target: ArrayLike | tuple[()] = (),
    compliance: ArrayLike = 0.0,
    rows: ArrayLike | tuple[()] = (),
    limit: ArrayLike | tuple[()] = (),
    lower: ArrayLike = -jnp.inf,
    upper: ArrayLike = jnp.inf,
) -> QuadraticProgram:
    """A program of which parts may be left out; shapes are filled in and checked.

    Raises ValueError where shapes do not fit.
    """
    linear = jnp.asarray(linear)
    n, dtype = linear.shape[0], linear.dtype
    jacobian, rows = jnp.asarray(jacobian, dtype).reshape(-1, n), jnp.asarray(rows, dtype).reshape(-1, n)
    m, k = jacobian.shape[0], rows.shape[0]
    hessian = jnp.asarray(hessian, dtype)
    program = QuadraticProgram(
        (hessian + hessian.T) / 2 if hessian.ndim == 2 else hessian,
        linear,
        jacobian,
        jnp.asarray(target, dtype),
        jnp.broadcast_to(jnp.asarray(compliance, dtype), (m,)),
        rows,
        jnp.asarray(limit, dtype),
        jnp.broadcast_to(jnp.asarray(lower, dtype), (n,)),
        jnp.broadcast_to(jnp.asarray(upper, dtype), (n,)),
    )
    shapes = {"hessian": [(n,), (n, n)], "target": [(m,)], "limit": [(k,)]}
    for name, allowed in shapes.items():
        found = getattr(program, name).shape
        if found not in allowed:
            raise ValueError(f"{name}: found shape {found}, allowed: {' or '.join(map(str, allowed))}")
    return program


def is_convex(problem: QuadraticProgram) -> Bool[Array, ""]:
    """Whether no weight is negative; a whole M is not looked at, since that would cost a factorisation."""
    bent = (problem.compliance < 0).any()
    return ~(bent | (problem.hessian < 0).any()) if problem.hessian.ndim == 1 else ~bent


def is_finite(problem: QuadraticProgram) -> Bool[Array, ""]:
    """Whether nothing is NaN, and nothing infinite but bounds that ask for nothing."""
    inner = [problem.hessian, problem.linear, problem.jacobian, problem.target, problem.compliance]
    total = (0 * problem.lower.clip(-1, jnp.inf) + 0 * problem.upper.clip(-jnp.inf, 1)).sum()
    for x in [
        *inner,
        problem.rows,
        problem.limit,
    ]:  # 0 times infinity is NaN; along one axis a time is faster
        total = total + ((0 * x).sum(0).sum() if x.size else 0)
    return total == 0
