"""What is solved, and what comes back."""

from enum import IntEnum

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int


class QuadraticProgram(eqx.Module):
    """min over x, s of 1/2 x'Mx + c'x + 1/2 s'Ls  subject to  Jx + s = v,  lower <= x <= upper: S1-(10),
    (11).

    `s` is the slack on the task rows of S1's reference [26]; it makes every program with ordered bounds
    feasible. It is eliminated in closed form, s = -y / L with the rows' multiplier y, and costs nothing.

    cost: diagonal of M, positive. linear: c. jacobian: J. target: v. slack_cost: diagonal of L, positive; the
    larger, the more a row is an equality.
    """

    cost: Float[Array, "n"]
    linear: Float[Array, "n"]
    jacobian: Float[Array, "m n"]
    target: Float[Array, "m"]
    slack_cost: Float[Array, "m"]
    lower: Float[Array, "n"]
    upper: Float[Array, "n"]


class QPStatus(IntEnum):
    """How a solution ended."""

    SOLVED = 0
    INFEASIBLE = 1  # a lower bound above its upper bound
    NOT_CONVERGED = 2  # a residual above the tolerance after the last iteration
    NOT_FINITE = 3  # NaN or infinity in the problem; the value is zero


class QPSolution(eqx.Module):
    """Value and statistics of one solved program.

    value: x, always finite and within the bounds (between them where they contradict each other). task_dual:
    y, the multiplier of the task rows. residual: the largest violation of the optimality conditions, scaled.
    status: a `QPStatus`.
    """

    value: Float[Array, "n"]
    task_dual: Float[Array, "m"]
    residual: Float[Array, ""]
    status: Int[Array, ""]


def is_finite(problem: QuadraticProgram) -> Bool[Array, ""]:
    """Whether no leaf of the problem holds NaN or infinity."""
    flags = [jnp.isfinite(x).all() for x in jax.tree.leaves(problem)]
    return jnp.stack(flags).all()
