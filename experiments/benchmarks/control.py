"""The QP of the whole-body controller beside solvers in C that are called in a loop, and beside qpax; a
control step beside one of MuJoCo with such a solver.
"""

import jax
import jax.numpy as jnp
import numpy as np

from experiments.benchmarks.compare import compare, rate
from experiments.benchmarks.control_step import ControlSteps
from experiments.benchmarks.limit import product_rate
from experiments.benchmarks.operations import operations
from experiments.benchmarks.qp_loop_peer import QpCases, random_cases, solve_by_daqp, solve_by_quadprog
from experiments.benchmarks.qpax_peer import qpax_answers
from experiments.benchmarks.rows import BenchRow
from experiments.benchmarks.serial_loop_peer import SerialLoops, control_steps_per_second
from jaxpaint.compiling import batched, on_devices
from opt.qp import quadratic_program, solve_qp

_SEED = 0
_COUNT, _COUNT_ROWS, _COUNT_QPAX = 16384, 8192, 512
_INEQUALITIES = 12
# How many worlds a device takes at a time, and its loops: the first as large as memory allows, the second
# as fits the cache.
_CHUNK, _BLOCK, _BLOCK_ROWS = 4096, 256, 128
_LIMIT = "a matrix product of numpy"


def rows() -> list[BenchRow]:
    """QPs a second: 9 variables, 6 equality rows, box bounds; then with inequality rows besides; and the
    floating-point operations a second which that comes to, beside the limit. Then control steps a second.
    """
    box, inequality = random_cases(_COUNT, _SEED), random_cases(_COUNT_ROWS, _SEED, _INEQUALITIES)
    small = random_cases(_COUNT_QPAX, _SEED)
    ours, ours_rows = Ours(box), Ours(inequality)
    return [
        compare("qp-box", ours.value, lambda: solve_by_daqp(box).rate, "DAQP in a loop"),
        compare("qp-box-quadprog", ours.value, lambda: solve_by_quadprog(box).rate, "quadprog in a loop"),
        compare("qp-inequality", ours_rows.value, lambda: solve_by_daqp(inequality).rate, "DAQP in a loop"),
        compare("qp-qpax", ours.value, lambda: qpax_answers(small).rate, "qpax, vmapped"),
        compare("qp-gradient", ours.gradient, ours.value, "the same without gradient"),
        compare("qp-box-operations", ours.work, product_rate, _LIMIT),
        compare("qp-inequality-operations", ours_rows.work, product_rate, _LIMIT),
        *_control_step(),
    ]


def _control_step() -> list[BenchRow]:
    steps, one = ControlSteps(), "MuJoCo and DAQP in a loop"
    with SerialLoops(2) as loops:
        return [
            compare("control-step", steps.rate, control_steps_per_second, one),
            compare("control-step-2-processes", steps.rate, loops.rate, f"{one}, two processes"),
        ]


class Ours:
    """Our solver on these cases, in float32."""

    def __init__(self, cases: QpCases) -> None:
        arrays = (np.diagonal(cases.hessian, axis1=1, axis2=2), *cases.arrays[1:])
        self.inputs = on_devices([jnp.asarray(x, jnp.float32) for x in arrays])
        self.count = len(cases)
        chunk = min(_CHUNK, self.count // jax.local_device_count())
        block = _BLOCK_ROWS if cases.arrays[4].shape[1] else _BLOCK
        self.run = batched(_value, in_axes=0, chunk=chunk, block=block)
        self.run_gradient = batched(_value_and_gradient, in_axes=0, chunk=chunk, block=block)

    def value(self) -> float:
        """Rate of solutions [1/s]."""
        return self._rate(self.run)

    def work(self) -> float:
        """Rate of floating-point operations [1/s], if no program takes more steps than all do."""
        return operations(_value, *(x[0] for x in self.inputs)) * self.value()

    def gradient(self) -> float:
        """Rate of solutions with the gradient of a function of each to all inputs [1/s]."""
        return self._rate(self.run_gradient)

    def _rate(self, run) -> float:
        return rate(lambda: jax.block_until_ready(run(*self.inputs)), self.count)


def _value(hessian, linear, jacobian, target, rows, limit, lower, upper):
    program = quadratic_program(
        hessian, linear, jacobian=jacobian, target=target, rows=rows, limit=limit, lower=lower, upper=upper
    )
    return solve_qp(program).value


def _value_and_gradient(hessian, linear, jacobian, target, rows, limit, lower, upper):
    def objective(*inputs):
        return (_value(*inputs) ** 2).sum()

    inputs = (hessian, linear, jacobian, target, rows, limit, lower, upper)
    return jax.value_and_grad(objective, argnums=tuple(range(len(inputs))))(*inputs)
