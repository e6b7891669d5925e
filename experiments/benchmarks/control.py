"""The QP of the whole-body controller beside solvers in C that are called in a loop."""

import time

import jax
import jax.numpy as jnp
import numpy as np

from experiments.benchmarks.compare import compare
from experiments.benchmarks.qp_loop_peer import random_cases, solve_by_daqp, solve_by_quadprog
from experiments.benchmarks.rows import BenchRow
from jaxpaint.compiling import batched
from opt.qp import QuadraticProgram, solve_qp

_COUNT, _SEED = 4096, 0
# The peers solve with hard equality rows; slack this dear leaves them a millionth.
_SLACK_COST = 1e5
_ITERATIONS = 10


def rows() -> list[BenchRow]:
    """QPs a second: 9 variables, 6 equality rows, box bounds."""
    cases = random_cases(_COUNT, _SEED)
    program = QuadraticProgram(
        cost=jnp.asarray(np.diagonal(cases.hessian, axis1=1, axis2=2), jnp.float32),
        linear=jnp.asarray(cases.linear, jnp.float32),
        jacobian=jnp.asarray(cases.jacobian, jnp.float32),
        target=jnp.asarray(cases.twist, jnp.float32),
        slack_cost=jnp.full((_COUNT, 6), _SLACK_COST, jnp.float32),
        lower=jnp.asarray(cases.lower, jnp.float32),
        upper=jnp.asarray(cases.upper, jnp.float32),
    )
    run = batched(lambda p: solve_qp(p, iterations=_ITERATIONS).value, in_axes=(0,), chunk=64)

    def ours() -> float:
        begin = time.perf_counter()
        jax.block_until_ready(run(program))
        return _COUNT / (time.perf_counter() - begin)

    return [
        compare("qp-box", ours, lambda: solve_by_daqp(cases).rate, "DAQP in a loop"),
        compare("qp-box-quadprog", ours, lambda: solve_by_quadprog(cases).rate, "quadprog in a loop"),
    ]
