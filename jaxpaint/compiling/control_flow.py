"""Loops, branches and calls when the worlds are the last axis."""

from collections.abc import Callable, Sequence

import jax
import jax.numpy as jnp
from jax import lax
from jax.extend import core

from jaxpaint.compiling.rules import Value, spread

Evaluate = Callable[[core.ClosedJaxpr, Sequence[Value], int], list[Value]]


def _closed(jaxpr) -> core.ClosedJaxpr:
    return jaxpr if isinstance(jaxpr, core.ClosedJaxpr) else core.ClosedJaxpr(jaxpr, ())


def _shapes(atoms) -> list[tuple[int, ...]]:
    return [v.aval.shape for v in atoms]


def _spread_all(
    values: Sequence[Value], shapes: Sequence[tuple[int, ...]], flags, worlds: int
) -> list[jax.Array]:
    """Arrays of the values, those that are flagged given a worlds axis."""
    return [
        spread(v, s, worlds) if f and not v.batched else v.array
        for v, s, f in zip(values, shapes, flags, strict=True)
    ]


def _batched_outputs(jaxpr: core.ClosedJaxpr, flags: Sequence[bool]) -> list[bool]:
    """Which results depend on a batched input: any operation with a batched input has batched results."""
    known = dict(zip(jaxpr.jaxpr.invars, flags, strict=True))
    for equation in jaxpr.jaxpr.eqns:
        flag = any(known.get(v, False) for v in equation.invars if not isinstance(v, core.Literal))
        known.update(dict.fromkeys(equation.outvars, flag))
    return [not isinstance(v, core.Literal) and known.get(v, False) for v in jaxpr.jaxpr.outvars]


def _settle(step: Callable[[list[bool]], list[bool]], carry: list[bool]) -> list[bool]:
    """The carry's flags once an iteration no longer adds any."""
    while (grown := [a or b for a, b in zip(carry, step(carry), strict=True)]) != carry:
        carry = grown
    return carry


def _call(equation, inputs: list[Value], worlds: int, evaluate: Evaluate) -> list[Value]:
    p = equation.params
    inner = p.get("jaxpr") or p.get("call_jaxpr") or p.get("fun_jaxpr")
    return evaluate(_closed(inner), inputs, worlds)


def _scan(equation, inputs: list[Value], worlds: int, evaluate: Evaluate) -> list[Value]:
    p, body = equation.params, equation.params["jaxpr"]
    n_const, n_carry = p["num_consts"], p["num_carry"]
    consts, init, xs = inputs[:n_const], inputs[n_const : n_const + n_carry], inputs[n_const + n_carry :]
    x_flags = [v.batched for v in xs]

    def outputs(carry: list[bool]) -> list[bool]:
        return _batched_outputs(body, [*(v.batched for v in consts), *carry, *x_flags])

    flags = _settle(lambda carry: outputs(carry)[:n_carry], [v.batched for v in init])
    y_flags = outputs(flags)[n_carry:]
    out_shapes = _shapes(body.jaxpr.outvars)

    def step(carry, x):
        values = [*consts, *map(Value, carry, flags), *map(Value, x, x_flags)]
        out = _spread_all(evaluate(body, values, worlds), out_shapes, [*flags, *y_flags], worlds)
        return tuple(out[:n_carry]), tuple(out[n_carry:])

    start = _spread_all(init, out_shapes[:n_carry], flags, worlds)
    carry, ys = lax.scan(
        step,
        tuple(start),
        tuple(v.array for v in xs),
        length=p["length"],
        reverse=p["reverse"],
        unroll=p["unroll"],
    )
    return [*map(Value, carry, flags), *map(Value, ys, y_flags)]


def _while(equation, inputs: list[Value], worlds: int, evaluate: Evaluate) -> list[Value]:
    p = equation.params
    test, body, n_test, n_body = p["cond_jaxpr"], p["body_jaxpr"], p["cond_nconsts"], p["body_nconsts"]
    test_consts, consts, init = inputs[:n_test], inputs[n_test : n_test + n_body], inputs[n_test + n_body :]
    flags = _settle(
        lambda carry: _batched_outputs(body, [*(v.batched for v in consts), *carry]),
        [v.batched for v in init],
    )
    by_world = _batched_outputs(test, [*(v.batched for v in test_consts), *flags])[0]
    flags = [True] * len(flags) if by_world else flags
    shapes = _shapes(body.jaxpr.outvars)

    def goes_on(carry):
        return evaluate(test, [*test_consts, *map(Value, carry, flags)], worlds)[0].array

    def step(carry):
        out = evaluate(body, [*consts, *map(Value, carry, flags)], worlds)
        new = _spread_all(out, shapes, flags, worlds)
        if by_world:  # a world that is done keeps its values
            live = goes_on(carry)
            new = [jnp.where(live, a, b) for a, b in zip(new, carry, strict=True)]
        return tuple(new)

    start = tuple(_spread_all(init, shapes, flags, worlds))
    out = lax.while_loop(lambda c: jnp.any(goes_on(c)) if by_world else goes_on(c), step, start)
    return list(map(Value, out, flags))


def _cond(equation, inputs: list[Value], worlds: int, evaluate: Evaluate) -> list[Value]:
    branches = equation.params["branches"]
    index, operands = inputs[0], inputs[1:]
    shapes = _shapes(equation.outvars)
    if index.batched:  # every world takes its own branch: all are evaluated
        results = [
            _spread_all(evaluate(b, operands, worlds), shapes, [True] * len(shapes), worlds) for b in branches
        ]
        return [Value(_choose(index.array, list(choices)), True) for choices in zip(*results, strict=True)]
    flag_sets = [_batched_outputs(b, [v.batched for v in operands]) for b in branches]
    flags = [any(column) for column in zip(*flag_sets, strict=True)]

    def run(branch):
        return lambda *arrays: tuple(
            _spread_all(
                evaluate(
                    branch, [Value(a, v.batched) for a, v in zip(arrays, operands, strict=True)], worlds
                ),
                shapes,
                flags,
                worlds,
            )
        )

    out = lax.switch(index.array, [run(b) for b in branches], *(v.array for v in operands))
    return list(map(Value, out, flags))


def _choose(index: jax.Array, choices: list[jax.Array]) -> jax.Array:
    out = choices[0]
    for i, choice in enumerate(choices[1:], start=1):
        out = jnp.where(index == i, choice, out)
    return out


CONTROL_FLOW = {
    **dict.fromkeys(
        [
            "jit",
            "pjit",
            "closed_call",
            "core_call",
            "custom_jvp_call",
            "custom_vjp_call",
            "remat",
            "checkpoint",
        ],
        _call,
    ),
    "scan": _scan,
    "while": _while,
    "cond": _cond,
}
