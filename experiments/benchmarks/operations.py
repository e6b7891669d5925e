"""Counts what a one-world function computes: its operations, loops of fixed length included."""

import math
from collections.abc import Callable

import jax
import jax.numpy as jnp
from jax.extend import core

_ARITHMETIC = {
    "add",
    "sub",
    "mul",
    "div",
    "max",
    "min",
    "neg",
    "abs",
    "sqrt",
    "integer_pow",
    "square",
    "add_any",
}
_REDUCTIONS = {"reduce_sum", "reduce_max", "reduce_min"}


def operations(function: Callable, *args) -> int:
    """Floating-point operations of one call; comparisons, selections and moves are free. A while loop counts
    as one round.
    """
    return _count(jax.make_jaxpr(function)(*args))


def _count(jaxpr: core.ClosedJaxpr) -> int:
    return sum(_of_equation(equation) for equation in jaxpr.jaxpr.eqns)


def _of_equation(equation: core.JaxprEqn) -> int:
    name, params = equation.primitive.name, equation.params
    if name in _ARITHMETIC | _REDUCTIONS and not jnp.issubdtype(equation.outvars[0].aval.dtype, jnp.floating):  # type: ignore[attr-defined]
        return 0
    if name in _ARITHMETIC:
        return math.prod(equation.outvars[0].aval.shape)  # type: ignore[attr-defined]
    if name in _REDUCTIONS:
        return math.prod(equation.invars[0].aval.shape)  # type: ignore[attr-defined]
    if name == "dot_general":
        shape = equation.invars[0].aval.shape  # type: ignore[attr-defined]
        summed = math.prod(shape[i] for i in params["dimension_numbers"][0][0])
        return 2 * summed * math.prod(equation.outvars[0].aval.shape)  # type: ignore[attr-defined]
    rounds = params.get("length", 1) if name == "scan" else 1
    inner = [v for v in params.values() if isinstance(v, core.ClosedJaxpr | core.Jaxpr)]
    return rounds * sum(
        _count(j if isinstance(j, core.ClosedJaxpr) else core.ClosedJaxpr(j, ())) for j in inner
    )
