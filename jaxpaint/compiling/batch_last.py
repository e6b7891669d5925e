"""Evaluates a one-world program with the worlds as the last axis and barriers on shared values.

Two reasons, both measured on CPUs; docs/compiling.md says more. XLA's fusion re-computes a value in each of
its consumers, which grows exponentially along kinematic chains and factorisations: an optimisation barrier on
what several of them read, unless it is made again in no time, stops that. And a loop over worlds vectorises
only if neighbours in memory are worlds, while `jax.vmap` moves the worlds to the front.
"""

from collections import Counter
from collections.abc import Callable, Sequence
from functools import partial

import jax
from jax.extend import core

from jaxpaint.compiling.control_flow import CONTROL_FLOW, in_blocks
from jaxpaint.compiling.effort import is_kept, weighed
from jaxpaint.compiling.rules import RULES, Value, fallback
from jaxpaint.compiling.small_matrices import written_out


def batch_last(
    jaxpr: core.ClosedJaxpr, args: Sequence[Value], worlds: int, block: int | None = None
) -> list[Value]:
    """Evaluates `jaxpr`; a `Value` that is batched has shape `[*one_world, worlds]`.

    block: how many worlds a loop takes at a time, see `in_blocks`; the worlds are a multiple of it.
    """
    body = jaxpr.jaxpr
    live = _live(body)
    reads = _count_reads(live, body.outvars)
    env: dict[core.Var, Value] = dict(
        zip(body.constvars, (Value(c, False) for c in jaxpr.consts), strict=True)
    )
    # What a call reads once may be read often inside.
    often = [is_kept(v, "", reads[x]) for v, x in zip(args, body.invars, strict=True)]
    env.update(zip(body.invars, _shield(list(args), often), strict=True))

    def read(atom) -> Value:
        return Value(atom.val, False) if isinstance(atom, core.Literal) else env[atom]

    for equation in live:
        inputs = [read(v) for v in equation.invars]
        results = weighed(equation, inputs, _evaluate(equation, inputs, worlds, block))
        kept = [
            is_kept(v, equation.primitive.name, reads[x])
            for v, x in zip(results, equation.outvars, strict=True)
        ]
        env.update(zip(equation.outvars, _shield(results, kept), strict=True))
    return [read(v) for v in body.outvars]


def _live(body: core.Jaxpr) -> list[core.JaxprEqn]:
    """The equations that a result depends on: a barrier would keep the others alive."""
    wanted = {v for v in body.outvars if not isinstance(v, core.Literal)}
    live = []
    for equation in reversed(body.eqns):
        if equation.effects or not wanted.isdisjoint(equation.outvars):
            live.append(equation)
            wanted.update(v for v in equation.invars if not isinstance(v, core.Literal))
    return live[::-1]


def _count_reads(equations: Sequence[core.JaxprEqn], results: Sequence) -> Counter:
    atoms = [v for equation in equations for v in equation.invars] + list(results)
    return Counter(v for v in atoms if not isinstance(v, core.Literal))


def _evaluate(
    equation: core.JaxprEqn, inputs: list[Value], worlds: int, block: int | None = None
) -> list[Value]:
    name = equation.primitive.name
    if block and worlds > block and any(v.batched for v in inputs):
        split = in_blocks(equation, inputs, worlds, block, batch_last)
        if split is not None:
            return split
    if name in CONTROL_FLOW:
        return CONTROL_FLOW[name](equation, inputs, worlds, partial(batch_last, block=block))
    if not any(v.batched for v in inputs):
        out = equation.primitive.bind(*(v.array for v in inputs), **equation.params)
        return [Value(x, False) for x in (out if equation.primitive.multiple_results else [out])]
    plain = written_out(equation)
    if plain is not None:
        return batch_last(plain, inputs, worlds)
    rule: Callable = RULES.get(name, fallback)
    return rule(equation, inputs, worlds)


def _shield(results: list[Value], shared: list[bool]) -> list[Value]:
    """Puts one barrier around the results that several equations read."""
    picked = [i for i, s in enumerate(shared) if s and results[i].batched]
    if not picked:
        return results
    held = jax.lax.optimization_barrier([results[i].array for i in picked])
    results = list(results)
    for i, array in zip(picked, held, strict=True):
        results[i] = Value(array, True, 0)
    return results
