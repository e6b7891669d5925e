"""How many hard quadratic programs are solved, and how well, beside DAQP and qpax (extra `bench`)."""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from experiments.benchmarks.qp_loop_peer import QpAnswers, QpCases, solve_by_daqp
from experiments.benchmarks.qp_sets import SETS, draw
from experiments.benchmarks.qpax_peer import qpax_answers
from experiments.reproduce.result import ReproduceResult, ReproduceSettings, Row
from jaxpaint.compiling import batched
from opt.qp import QPStatus, quadratic_program, solve_qp

NAME = "qp-accuracy"
COUNT = 512
_CLOSE = 1e-5


def run(settings: ReproduceSettings | None = None, count: int = COUNT) -> ReproduceResult:
    """What each solver says of its answers, and what is true of all of them.

    A solver's word alone would mislead: qpax's default tolerance is below what float32 can show.
    """
    seed = (settings or ReproduceSettings()).seed
    rows: list[Row] = []
    for name in SETS:
        cases = draw(name, count, seed)
        reference = solve_by_daqp(cases)
        for solver, answers in (
            ("ours (float32)", ours(cases)),
            ("DAQP (float64)", reference),
            ("qpax (float32)", qpax_answers(cases)),
        ):
            rows += _rows(name, solver, cases, answers.x, answers.solved, reference.x)
    return ReproduceResult.of(rows, {})


def ours(cases: QpCases) -> QpAnswers:
    """Our solver in float32, with the whole of M."""
    solution = _OURS(*(jnp.asarray(x, jnp.float32) for x in cases.arrays))
    solved = np.asarray(solution.status) == QPStatus.SOLVED
    return QpAnswers(np.asarray(solution.value, float), solved, float("nan"))


def _solution(hessian, linear, jacobian, target, rows, limit, lower, upper):
    return solve_qp(
        quadratic_program(
            hessian,
            linear,
            jacobian=jacobian,
            target=target,
            rows=rows,
            limit=limit,
            lower=lower,
            upper=upper,
        )
    )


_OURS = batched(_solution, in_axes=0, chunk=256)


def violation(cases: QpCases, x: Float[np.ndarray, "cases n"]) -> Float[np.ndarray, " cases"]:
    """The largest by which a row or bound is missed."""
    task = np.abs(np.einsum("nij,nj->ni", cases.jacobian, x) - cases.twist).max(axis=1)
    over = (np.einsum("nij,nj->ni", cases.rows, x) - cases.limit).max(axis=1, initial=0.0)
    bounds = np.maximum(x - cases.upper, cases.lower - x).max(axis=1)
    return np.maximum.reduce([task, over, bounds])


def _rows(name: str, solver: str, cases: QpCases, x, called: np.ndarray, reference) -> list[Row]:
    finite = np.isfinite(x).all(axis=1)
    missed = np.where(finite, violation(cases, np.where(finite[:, None], x, 0.0)), np.inf)
    off = np.where(finite, np.abs(x - reference).max(axis=1), np.inf)
    values = {
        "called solved": called.mean(),
        "meets all rows and bounds to 1e-5": (missed <= _CLOSE).mean(),
        "median violation": np.median(missed),
        "largest violation": missed.max(),
        "median distance to DAQP": np.median(off),
    }
    return [Row(f"{name}: {what}", solver, None, float(value)) for what, value in values.items()]
