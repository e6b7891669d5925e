"""What tasks and limits are made of: the four kinds of pieces that add up to one quadratic program."""

from collections.abc import Sequence
from functools import reduce
from typing import NamedTuple, TypeVar

import jax.numpy as jnp
from jaxtyping import Array, Float


class Objective(NamedTuple):
    """1/2 q' diag(hessian) q + linear' q: a part of S1-(10)."""

    hessian: Float[Array, "n"]
    linear: Float[Array, "n"]


class Equalities(NamedTuple):
    """rows q + s = target, at the cost 1/2 s' diag(compliance)^-1 s; compliance 0: s = 0 (hard)."""

    rows: Float[Array, "m n"]
    target: Float[Array, "m"]
    compliance: Float[Array, "m"]


class Inequalities(NamedTuple):
    """rows q <= limit: A and B of S1-(11)."""

    rows: Float[Array, "k n"]
    limit: Float[Array, "k"]


Rows = TypeVar("Rows", Equalities, Inequalities)


class Bounds(NamedTuple):
    """lower <= q <= upper: Q'min and Q'max of S1-(11); infinity asks for nothing."""

    lower: Float[Array, "n"]
    upper: Float[Array, "n"]


def summed(objectives: Sequence[Objective]) -> Objective:
    """All objectives together."""
    return reduce(lambda a, b: Objective(a.hessian + b.hessian, a.linear + b.linear), objectives)


def stacked(parts: Sequence[Rows]) -> Rows:
    """The rows of all, one below the other."""
    return type(parts[0])(*(jnp.concatenate(columns) for columns in zip(*parts, strict=True)))


def no_rows(n: int, dtype) -> Inequalities:
    """Of n velocities, nothing is asked."""
    return Inequalities(jnp.zeros((0, n), dtype), jnp.zeros((0,), dtype))


def met(bounds: Sequence[Bounds]) -> Bounds:
    """What all bounds allow; where they contradict each other, lower > upper."""
    return reduce(lambda a, b: Bounds(jnp.maximum(a.lower, b.lower), jnp.minimum(a.upper, b.upper)), bounds)


def joined(first: Bounds, second: Bounds) -> Bounds:
    """The bounds of two groups of velocities, one after the other."""
    return Bounds(jnp.concatenate([first.lower, second.lower]), jnp.concatenate([first.upper, second.upper]))
