"""What lies in memory, or is made again in no time, gets no barrier; what takes long to make anew does."""

import jax
import jax.numpy as jnp
import pytest

from jaxpaint.compiling import batch_last
from jaxpaint.compiling.rules import Value


def parts(x):
    """Each part is read twice."""
    a, b, c = x[0], x[1:], x.reshape(2, 2)[1]
    return a * a + a, b * b + b, c * c + c


def cheap(x):
    doubled = x + x
    return doubled * x, doubled - x, 1 - doubled


def often(x):
    doubled = x + x
    return tuple(doubled * k for k in range(2, 6))


def long(x):
    chain = x * x + x
    return chain - x, 3 * chain - x, 2 * chain + x


def dear(x):
    root = jnp.sqrt(x)
    return root + x, root - x


def part_of_long(x):
    chain = (x * x + x) * x
    return chain[0] + 1, chain[0] - 1


def often_in_a_call(x):
    """The call reads once what is read three times inside."""
    return jax.jit(lambda y: (y + 1, y - 1, y * y))((x * x + x) * x)


def in_a_loop(x):
    return jax.lax.scan(lambda c, row: (c + row[0] * row[0], row[1] - c), x[0], x.reshape(2, 2))


@pytest.mark.parametrize(
    ("function", "barriers"),
    [
        (parts, 0),
        (cheap, 0),
        (often, 1),
        (long, 1),
        (dear, 1),
        (part_of_long, 1),
        (often_in_a_call, 1),
        (in_a_loop, 0),
    ],
)
def test_barriers(function, barriers):
    jaxpr = jax.make_jaxpr(function)(jnp.ones(4))

    def program(x):
        return [v.array for v in batch_last(jaxpr, [Value(x, True, 0)], 8)]

    assert str(jax.make_jaxpr(program)(jnp.ones((4, 8)))).count("optimization_barrier") == barriers
