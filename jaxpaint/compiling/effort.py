"""What it takes to make a value again, and so which values are kept in memory."""

from collections.abc import Sequence

from jax.extend import core

from jaxpaint.compiling.rules import Value

# Parts of an array, or an array in another shape: to read them is to read the array.
_PARTS = {
    "broadcast_in_dim",
    "convert_element_type",
    "copy",
    "expand_dims",
    "iota",
    "reshape",
    "slice",
    "split",
    "squeeze",
    "transpose",
    "unstack",
}
# To do one of these again takes a reader about as long as to fetch its result.
_CHEAP = {
    "abs",
    "add",
    "add_any",
    "and",
    "eq",
    "ge",
    "gt",
    "le",
    "lt",
    "max",
    "min",
    "mul",
    "name",
    "ne",
    "neg",
    "not",
    "or",
    "pad",
    "select_n",
    "square",
    "stop_gradient",
    "sub",
}
# Kept though one operation alone reads them: fused into a concatenation or a broadcast, they would be
# evaluated anew for every element of it.
_KEPT = {"reduce_sum", "dot_general", "concatenate", "stack", "sin", "cos", "atan2", "exp", "log", "tanh"}
# Of all operations that are neither parts nor cheap.
_DEAR = 100
# Readers of a value may do so many operations again between them before it is kept. Measured, of a gradient
# through painting steps: 1, 2 and 3 are alike, a tenth faster than 0; 6 is slower again.
_AGAIN = 2


def weighed(equation: core.JaxprEqn, inputs: Sequence[Value], results: Sequence[Value]) -> list[Value]:
    """The results of an equation with their effort, where the rule that made them did not know it."""
    name = equation.primitive.name
    own = 0 if name in _PARTS else 1 if name in _CHEAP else _DEAR
    effort = own + sum(v.effort or 0 for v in inputs if v.batched)
    return [v if v.effort is not None else v._replace(effort=effort) for v in results]


def is_kept(value: Value, name: str, reads: int) -> bool:
    """Whether the result of an operation of this name that so many others read is kept in memory."""
    effort = value.effort or 0
    return effort > 0 and (name in _KEPT or effort * (reads - 1) > _AGAIN)
