"""How single operations act when the worlds are the last axis."""

from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import lax
from jax.extend import core


class Value(NamedTuple):
    """An array of a program; when batched, its last axis counts worlds. effort: operations that make an
    element of it anew from what lies in memory, if that is known: 0 for what lies there, or is part of it.
    """

    array: Any
    batched: bool
    effort: int | None = None


Rule = Callable[[core.JaxprEqn, list[Value], int], list[Value]]

_ELEMENTWISE = [
    "abs",
    "acos",
    "acosh",
    "add",
    "add_any",
    "and",
    "asin",
    "asinh",
    "atan",
    "atan2",
    "atanh",
    "cbrt",
    "ceil",
    "clamp",
    "convert_element_type",
    "copy",
    "copy_p",
    "cos",
    "cosh",
    "div",
    "eq",
    "erf",
    "erf_inv",
    "erfc",
    "exp",
    "exp2",
    "expm1",
    "floor",
    "ge",
    "gt",
    "imag",
    "integer_pow",
    "is_finite",
    "le",
    "lgamma",
    "log",
    "log1p",
    "logistic",
    "lt",
    "max",
    "min",
    "mul",
    "ne",
    "neg",
    "name",
    "nextafter",
    "not",
    "or",
    "population_count",
    "pow",
    "real",
    "rem",
    "round",
    "rsqrt",
    "select_n",
    "shift_left",
    "shift_right_arithmetic",
    "shift_right_logical",
    "sign",
    "sin",
    "sinh",
    "sqrt",
    "square",
    "stop_gradient",
    "sub",
    "tan",
    "tanh",
    "xor",
    "reduce_precision",
]
_SAME_AXES = [
    "reduce_sum",
    "reduce_max",
    "reduce_min",
    "reduce_prod",
    "reduce_and",
    "reduce_or",
    "argmax",
    "argmin",
    "squeeze",
    "rev",
    "cumsum",
    "cumprod",
    "cummax",
    "cummin",
    "cumlogsumexp",
]
# Products up to this many multiplications per world are sums along small axes, which vectorise over the
# worlds; larger ones go to the library.
_SMALL_PRODUCT = 4096

# Sums and extremes over so many values are written out.
_SHORT_SUM = 32


def spread(value: Value, shape: tuple[int, ...], worlds: int) -> jax.Array:
    """The value with the one-world shape `shape` and the worlds behind it."""
    array = jnp.asarray(value.array)
    if not value.batched and array.ndim > 0:
        array = array[..., None]
    return jnp.broadcast_to(array, (*shape, worlds))


def _elementwise(equation: core.JaxprEqn, inputs: list[Value], worlds: int) -> list[Value]:
    shape = equation.outvars[0].aval.shape  # type: ignore[attr-defined]
    arrays = [spread(v, shape, worlds) for v in inputs]
    return [Value(equation.primitive.bind(*arrays, **equation.params), True)]


def _reduce(equation: core.JaxprEqn, inputs: list[Value], worlds: int) -> list[Value]:
    """A short sum as additions: XLA would walk along the summed axis inside, not along the worlds."""
    array = inputs[0].array
    axes = equation.params["axes"]
    shape = array.shape
    count = int(np.prod([shape[a] for a in axes], dtype=int))
    if count > _SHORT_SUM or count == 0:
        return _same_axes(equation, inputs, worlds)
    combine = {"reduce_sum": lax.add, "reduce_max": lax.max, "reduce_min": lax.min}[equation.primitive.name]
    kept = [a for a in range(array.ndim) if a not in axes]
    array = jnp.transpose(array, (*axes, *kept)).reshape(count, *(shape[a] for a in kept))
    total = array[0]
    for k in range(1, count):
        total = combine(total, array[k])
    return [Value(total, True)]


def _same_axes(equation: core.JaxprEqn, inputs: list[Value], worlds: int) -> list[Value]:
    return [Value(equation.primitive.bind(inputs[0].array, **equation.params), True)]


def _broadcast_in_dim(equation: core.JaxprEqn, inputs: list[Value], worlds: int) -> list[Value]:
    shape, axes = equation.params["shape"], equation.params["broadcast_dimensions"]
    out = lax.broadcast_in_dim(inputs[0].array, (*shape, worlds), (*axes, len(shape)))
    return [Value(out, True)]


def _reshape(equation: core.JaxprEqn, inputs: list[Value], worlds: int) -> list[Value]:
    if equation.params.get("dimensions") is not None:
        return fallback(equation, inputs, worlds)
    return [Value(lax.reshape(inputs[0].array, (*equation.params["new_sizes"], worlds)), True)]


def _transpose(equation: core.JaxprEqn, inputs: list[Value], worlds: int) -> list[Value]:
    axes = equation.params["permutation"]
    return [Value(lax.transpose(inputs[0].array, (*axes, len(axes))), True)]


def _concatenate(equation: core.JaxprEqn, inputs: list[Value], worlds: int) -> list[Value]:
    shapes = [atom.aval.shape for atom in equation.invars]  # type: ignore[attr-defined]
    arrays = [spread(v, shape, worlds) for v, shape in zip(inputs, shapes, strict=True)]
    return [Value(lax.concatenate(arrays, equation.params["dimension"]), True)]


def _stack(equation: core.JaxprEqn, inputs: list[Value], worlds: int) -> list[Value]:
    shape, axis = equation.invars[0].aval.shape, equation.params["axis"]  # type: ignore[attr-defined]
    arrays = [jnp.expand_dims(spread(v, shape, worlds), axis) for v in inputs]
    return [Value(lax.concatenate(arrays, axis), True)]


def _unstack(equation: core.JaxprEqn, inputs: list[Value], worlds: int) -> list[Value]:
    array, axis = inputs[0].array, equation.params["axis"]
    parts = [lax.index_in_dim(array, k, axis, keepdims=False) for k in range(array.shape[axis])]
    return [Value(part, True) for part in parts]


def _slice(equation: core.JaxprEqn, inputs: list[Value], worlds: int) -> list[Value]:
    p = equation.params
    strides = None if p["strides"] is None else (*p["strides"], 1)
    out = lax.slice(inputs[0].array, (*p["start_indices"], 0), (*p["limit_indices"], worlds), strides)
    return [Value(out, True)]


def _pad(equation: core.JaxprEqn, inputs: list[Value], worlds: int) -> list[Value]:
    if inputs[1].batched:
        return fallback(equation, inputs, worlds)
    array = spread(inputs[0], equation.invars[0].aval.shape, worlds)  # type: ignore[attr-defined]
    config = [*equation.params["padding_config"], (0, 0, 0)]
    return [Value(lax.pad(array, inputs[1].array, config), True)]


def _dynamic_slice(equation: core.JaxprEqn, inputs: list[Value], worlds: int) -> list[Value]:
    operand, *starts = inputs
    sizes = (*equation.params["slice_sizes"], worlds)
    if any(s.batched for s in starts):
        return [Value(_slice_by_world(operand, starts, equation, worlds), True)]
    zero = jnp.zeros_like(starts[0].array) if starts else 0
    return [Value(lax.dynamic_slice(operand.array, [*(s.array for s in starts), zero], sizes), True)]


def _slice_by_world(operand: Value, starts: list[Value], equation: core.JaxprEqn, worlds: int) -> jax.Array:
    """A slice that begins elsewhere in each world, gathered where it lies; JAX's rule transposes it all."""
    shape, sizes = equation.invars[0].aval.shape, equation.params["slice_sizes"]  # type: ignore[attr-defined]
    whole, rank = spread(operand, shape, worlds), len(shape)
    limits = [size - part for size, part in zip(shape, sizes, strict=True)]
    columns = [jnp.clip(spread(s, (), worlds), 0, limit) for s, limit in zip(starts, limits, strict=True)]
    indices = jnp.stack([*columns, jnp.arange(worlds, dtype=columns[0].dtype)], axis=-1)
    numbers = lax.GatherDimensionNumbers(
        offset_dims=tuple(range(rank)), collapsed_slice_dims=(rank,), start_index_map=tuple(range(rank + 1))
    )
    return lax.gather(whole, indices, numbers, (*sizes, 1), mode=lax.GatherScatterMode.PROMISE_IN_BOUNDS)


def _dynamic_update_slice(equation: core.JaxprEqn, inputs: list[Value], worlds: int) -> list[Value]:
    operand, update, *starts = inputs
    if any(s.batched for s in starts):
        return fallback(equation, inputs, worlds)
    zero = jnp.zeros_like(starts[0].array) if starts else 0
    whole = spread(operand, equation.invars[0].aval.shape, worlds)  # type: ignore[attr-defined]
    part = spread(update, equation.invars[1].aval.shape, worlds)  # type: ignore[attr-defined]
    return [Value(lax.dynamic_update_slice(whole, part, [*(s.array for s in starts), zero]), True)]


def _split(equation: core.JaxprEqn, inputs: list[Value], worlds: int) -> list[Value]:
    array, axis = inputs[0].array, equation.params["axis"]
    ends = np.cumsum(equation.params["sizes"])
    begins = ends - equation.params["sizes"]
    return [
        Value(lax.slice_in_dim(array, int(a), int(b), axis=axis), True)
        for a, b in zip(begins, ends, strict=True)
    ]


def _gather(equation: core.JaxprEqn, inputs: list[Value], worlds: int) -> list[Value]:
    """The same places in all worlds: whole rows of worlds are taken."""
    operand, indices = inputs
    if indices.batched:
        return fallback(equation, inputs, worlds)
    numbers, rank = equation.params["dimension_numbers"], len(equation.outvars[0].aval.shape)  # type: ignore[attr-defined]
    params = equation.params | {
        "dimension_numbers": numbers._replace(offset_dims=(*numbers.offset_dims, rank)),
        "slice_sizes": (*equation.params["slice_sizes"], worlds),
    }
    return [Value(equation.primitive.bind(operand.array, indices.array, **params), True)]


def _scatter(equation: core.JaxprEqn, inputs: list[Value], worlds: int) -> list[Value]:
    operand, indices, updates = inputs
    if indices.batched:
        return fallback(equation, inputs, worlds)
    shapes = [atom.aval.shape for atom in equation.invars]  # type: ignore[attr-defined]
    numbers = equation.params["dimension_numbers"]
    window = (*numbers.update_window_dims, len(shapes[2]))
    params = equation.params | {"dimension_numbers": numbers._replace(update_window_dims=window)}
    whole, parts = spread(operand, shapes[0], worlds), spread(updates, shapes[2], worlds)
    return [Value(equation.primitive.bind(whole, indices.array, parts, **params), True)]


def _dot_general(equation: core.JaxprEqn, inputs: list[Value], worlds: int) -> list[Value]:
    (left_sum, right_sum), (left_batch, right_batch) = equation.params["dimension_numbers"]
    shapes = [atom.aval.shape for atom in equation.invars]  # type: ignore[attr-defined]
    out_aval = equation.outvars[0].aval
    summed = int(np.prod([shapes[0][i] for i in left_sum], dtype=int))
    if summed * int(np.prod(out_aval.shape, dtype=int)) > _SMALL_PRODUCT:  # type: ignore[attr-defined]
        return fallback(equation, inputs, worlds)
    left, left_free = _to_front(spread(inputs[0], shapes[0], worlds), left_batch, left_sum)
    right, right_free = _to_front(spread(inputs[1], shapes[1], worlds), right_batch, right_sum)
    depth = len(left_batch) + len(left_sum)
    left = jnp.expand_dims(left, tuple(range(depth + left_free, depth + left_free + right_free)))
    right = jnp.expand_dims(right, tuple(range(depth, depth + left_free)))
    front = len(left_batch)
    if front == 0 and 0 < summed <= _SHORT_SUM:
        left = left.reshape(summed, *left.shape[depth:])
        right = right.reshape(summed, *right.shape[depth:])
        out = left[0] * right[0]
        for k in range(1, summed):
            out = out + left[k] * right[k]
    else:
        out = (left * right).sum(tuple(range(front, depth)))
    return [Value(out.astype(out_aval.dtype), True)]  # type: ignore[attr-defined]


def _to_front(array: jax.Array, batch: tuple[int, ...], summed: tuple[int, ...]) -> tuple[jax.Array, int]:
    """Orders axes as batch, summed, free, worlds; returns how many are free."""
    last = array.ndim - 1
    free = [i for i in range(last) if i not in batch and i not in summed]
    return jnp.transpose(array, (*batch, *summed, *free, last)), len(free)


def fallback(equation: core.JaxprEqn, inputs: list[Value], worlds: int) -> list[Value]:
    """JAX's own batching of one operation, told where the worlds are."""
    axes = tuple(-1 if v.batched else None for v in inputs)

    def bind(*arrays):
        return equation.primitive.bind(*arrays, **equation.params)

    out = jax.vmap(bind, in_axes=axes, out_axes=-1)(*(v.array for v in inputs))
    return [Value(x, True) for x in (out if equation.primitive.multiple_results else [out])]


RULES: dict[str, Rule] = {
    **dict.fromkeys(_ELEMENTWISE, _elementwise),
    **dict.fromkeys(_SAME_AXES, _same_axes),
    **dict.fromkeys(["reduce_sum", "reduce_max", "reduce_min"], _reduce),
    "broadcast_in_dim": _broadcast_in_dim,
    "reshape": _reshape,
    "transpose": _transpose,
    "concatenate": _concatenate,
    "stack": _stack,
    "unstack": _unstack,
    "slice": _slice,
    "pad": _pad,
    "dynamic_slice": _dynamic_slice,
    "dynamic_update_slice": _dynamic_update_slice,
    "split": _split,
    "gather": _gather,
    **dict.fromkeys(["scatter", "scatter-add"], _scatter),
    "dot_general": _dot_general,
}
