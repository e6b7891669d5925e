"""Loops, branches and calls when the worlds are the last axis."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax import lax
from jax.extend import core

from jaxpaint.compiling.rules import Value, spread

# Evaluates a one-world program for so many worlds.
Evaluate = Callable[[core.ClosedJaxpr, Sequence[Value], int], list[Value]]


def _held(arrays, flags) -> list[Value]:
    """What goes into a loop or comes out of one lies in memory."""
    return [Value(array, flag, effort=0) for array, flag in zip(arrays, flags, strict=True)]


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
        values = [*consts, *_held(carry, flags), *_held(x, x_flags)]
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
    return [*_held(carry, flags), *_held(ys, y_flags)]


class _Loop(NamedTuple):
    """A while loop. by_world: the worlds end one by one. flags: which of the carry differ between worlds."""

    params: dict
    shapes: list[tuple[int, ...]]
    flags: list[bool]
    by_world: bool
    evaluate: Evaluate

    def goes_on(self, consts: Sequence[Value], carry, worlds: int) -> jax.Array:
        values = [*consts[: self.params["cond_nconsts"]], *_held(carry, self.flags)]
        return self.evaluate(self.params["cond_jaxpr"], values, worlds)[0].array

    def run(self, consts: Sequence[Value], start, worlds: int):
        """The carry once no world goes on; a world that is done keeps its values."""

        def step(carry):
            values = [*consts[self.params["cond_nconsts"] :], *_held(carry, self.flags)]
            out = self.evaluate(self.params["body_jaxpr"], values, worlds)
            new = _spread_all(out, self.shapes, self.flags, worlds)
            if self.by_world:
                live = self.goes_on(consts, carry, worlds)
                new = [jnp.where(live, a, b) for a, b in zip(new, carry, strict=True)]
            return tuple(new)

        def test(carry):
            live = self.goes_on(consts, carry, worlds)
            return jnp.any(live) if self.by_world else live

        return lax.while_loop(test, step, start)


def _while(equation, inputs: list[Value], worlds: int, evaluate: Evaluate) -> list[Value]:
    loop, consts, start = _prepared_while(equation, inputs, worlds, evaluate)
    return _held(loop.run(consts, start, worlds), loop.flags)


def _prepared_while(equation, inputs: list[Value], worlds: int, evaluate: Evaluate):
    p = equation.params
    count = p["cond_nconsts"] + p["body_nconsts"]
    consts, init = inputs[:count], inputs[count:]
    body_consts = [v.batched for v in consts[p["cond_nconsts"] :]]
    flags = _settle(
        lambda carry: _batched_outputs(p["body_jaxpr"], [*body_consts, *carry]), [v.batched for v in init]
    )
    test_consts = [v.batched for v in consts[: p["cond_nconsts"]]]
    by_world = _batched_outputs(p["cond_jaxpr"], [*test_consts, *flags])[0]
    flags = [True] * len(flags) if by_world else flags
    shapes = _shapes(p["body_jaxpr"].jaxpr.outvars)
    start = tuple(_spread_all(init, shapes, flags, worlds))
    return _Loop(p, shapes, flags, by_world, evaluate), consts, start


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
                evaluate(branch, _held(arrays, [v.batched for v in operands]), worlds),
                shapes,
                flags,
                worlds,
            )
        )

    out = lax.switch(index.array, [run(b) for b in branches], *(v.array for v in operands))
    return _held(out, flags)


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
            "remat2",
        ],
        _call,
    ),
    "scan": _scan,
    "while": _while,
    "cond": _cond,
}


_PLAIN_CALLS = {"jit", "pjit", "closed_call"}


def in_blocks(
    equation, inputs: list[Value], worlds: int, block: int, evaluate: Evaluate
) -> list[Value] | None:
    """A loop over many worlds, so many at a time; None where the equation is no loop that can be split.

    Rounds of a fixed number, and calls that make such, are made by one block of worlds after the other. A
    loop that the worlds leave one by one takes some of those that go on, in turn, until none does: so the
    slowest few do not keep all others busy.
    """
    if equation.primitive.name == "scan":
        return _block_by_block(_scan, equation, inputs, worlds, block, evaluate)
    if equation.primitive.name in _PLAIN_CALLS and _is_heavy(equation.params["jaxpr"]):
        return _block_by_block(_call, equation, inputs, worlds, block, evaluate)
    if equation.primitive.name == "while":
        return _while_in_blocks(equation, inputs, worlds, block, evaluate)
    return None


def _is_heavy(jaxpr: core.ClosedJaxpr) -> bool:
    """Whether there are rounds of a fixed number in it, and no others."""
    names = _loops(jaxpr)
    return "scan" in names and "while" not in names


def _loops(jaxpr: core.ClosedJaxpr) -> set[str]:
    names = {e.primitive.name for e in jaxpr.jaxpr.eqns}
    inner = [e.params.get("jaxpr") for e in jaxpr.jaxpr.eqns if e.primitive.name in _PLAIN_CALLS]
    return names.union(*(_loops(_closed(j)) for j in inner))


def _block_by_block(run_one, equation, inputs, worlds: int, block: int, evaluate: Evaluate) -> list[Value]:
    batched: list[bool] = []

    def run(begin):
        parts = [_part(v, lambda x: lax.dynamic_slice_in_dim(x, begin, block, x.ndim - 1)) for v in inputs]
        out = run_one(equation, parts, block, evaluate)
        batched[:] = [v.batched for v in out]
        return [v.array for v in out]

    stacked = lax.map(run, block * jnp.arange(worlds // block))
    return [
        Value(jnp.moveaxis(x, 0, -2).reshape(*x.shape[1:-1], worlds), True) if b else Value(x[0], False)
        for x, b in zip(stacked, batched, strict=True)
    ]


def _while_in_blocks(equation, inputs, worlds: int, block: int, evaluate: Evaluate) -> list[Value] | None:
    loop, consts, start = _prepared_while(equation, inputs, worlds, evaluate)
    if not loop.by_world:
        return None

    def advance(state):
        after, carry = state
        count = jnp.cumsum(loop.goes_on(consts, carry, worlds))
        index = _next_places(count, after, block)
        few = [_part(v, lambda x: jnp.take(x, index, axis=-1, mode="clip")) for v in consts]
        own = tuple(jnp.take(x, index, axis=-1, mode="clip") for x in carry)
        out = loop.run(few, own, block)
        return index[-1], tuple(
            a.at[..., index].set(b, mode="drop", unique_indices=True) for a, b in zip(carry, out, strict=True)
        )

    _, out = lax.while_loop(
        lambda state: jnp.any(loop.goes_on(consts, state[1], worlds)),
        advance,
        (jnp.asarray(worlds - 1), start),
    )
    return _held(out, loop.flags)


def _next_places(count: jax.Array, after: jax.Array, block: int) -> jax.Array:
    """Of the worlds that go on, so many that come next after one, beginning anew at the end. count: how many
    go on, up to each. Where fewer go on, the rest of the places stand beyond the last world, and come to
    nothing.
    """
    worlds, total = count.shape[0], count[-1]
    passed = jnp.where(after < worlds, count[jnp.minimum(after, worlds - 1)], total)
    nth = jnp.arange(1, block + 1)
    rank = passed + nth
    rank = jnp.where(nth <= total, jnp.where(rank > total, rank - total, rank), worlds + 1)
    return jnp.searchsorted(count, rank, method="compare_all")


def _part(value: Value, take: Callable[[jax.Array], jax.Array]) -> Value:
    return Value(take(value.array), True) if value.batched else value
