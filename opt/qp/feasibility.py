"""Proofs that no point of the box meets the rows."""

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from opt.qp.problem import QuadraticProgram

# Violations below this [units of v and b] are rounding, not infeasibility, by precision.
LEAST_VIOLATION = {"float32": 5e-6, "float64": 1e-9}


def proves_infeasible(
    problem: QuadraticProgram, dual_task: Float[Array, "m"], dual_rows: Float[Array, "k"]
) -> Bool[Array, ""]:
    """Whether these multipliers l (those of inequalities 0 or more) are a proof, after Farkas.

    For every x in the box, l'(Gx - g) <= |l| |violation|, with G and g of the hard rows. So the least value
    of l'(Gx - g) over the box, a sum of one term a variable, divided by |l|, is a lower bound on the
    violation.
    """
    task, rows = dual_task * (problem.compliance == 0), dual_rows
    slope = (problem.jacobian * task[:, None]).sum(0) + (problem.rows * rows[:, None]).sum(0)
    least = jnp.minimum(slope * problem.lower, slope * problem.upper).sum()
    least = least - (task * problem.target).sum() - (rows * problem.limit).sum()
    size = jnp.sqrt((task**2).sum() + (rows**2).sum())
    return least > LEAST_VIOLATION[problem.linear.dtype.name] * size
