"""Peer of the batched QP: DAQP and quadprog, one case at a time in a Python loop, as a user would call them.

    minimise  1/2 x'Hx + c'x   subject to   J x = twist,   lower <= x <= upper

with 9 joint velocities x and 6 task rows. Needs the extra `bench`.
"""

import time
from dataclasses import dataclass

import daqp
import numpy as np
import quadprog
from jaxtyping import Bool, Float

JOINTS, TASK_ROWS = 9, 6

# DAQP's marks for its rows, the box first: 0 is an inequality; 5 an equality (active 1, and never dropped 4).
_SENSE = np.array([0] * JOINTS + [5] * TASK_ROWS, dtype=np.int32)


@dataclass(frozen=True)
class QpCases:
    """Random problems of the whole-body controller; about 3 % have no solution."""

    hessian: Float[np.ndarray, "cases 9 9"]
    linear: Float[np.ndarray, "cases 9"]
    jacobian: Float[np.ndarray, "cases 6 9"]
    twist: Float[np.ndarray, "cases 6"]
    lower: Float[np.ndarray, "cases 9"]
    upper: Float[np.ndarray, "cases 9"]

    def __len__(self) -> int:
        return len(self.linear)


@dataclass(frozen=True)
class QpAnswers:
    """What a solver found: `x` [rad/s, m/s] holds where `solved`; `rate` is in problems a second."""

    x: Float[np.ndarray, "cases 9"]
    solved: Bool[np.ndarray, " cases"]
    rate: float


def random_cases(count: int, seed: int) -> QpCases:
    """`count` problems: base columns of unit scale, arm columns of half, twists of 0.15, bounds of 0.15 to 1.

    The order of the draws is part of the meaning: it makes one seed give the same problems everywhere.
    """
    rng = np.random.default_rng(seed)
    reach = np.repeat([1.0, 0.5], [3, 6])
    return QpCases(
        hessian=np.broadcast_to(0.01 * np.eye(JOINTS), (count, JOINTS, JOINTS)).copy(),
        linear=0.02 * rng.normal(size=(count, JOINTS)),
        jacobian=rng.normal(size=(count, TASK_ROWS, JOINTS)) * reach,
        twist=0.15 * rng.normal(size=(count, TASK_ROWS)),
        lower=-rng.uniform(0.15, 1.0, size=(count, JOINTS)),
        upper=rng.uniform(0.15, 1.0, size=(count, JOINTS)),
    )


def solve_by_daqp(cases: QpCases) -> QpAnswers:
    """DAQP's dual active set in float64: the reference answer."""
    x, solved = np.zeros((len(cases), JOINTS)), np.zeros(len(cases), dtype=bool)
    start = time.perf_counter()
    for i in range(len(cases)):
        above = np.r_[cases.upper[i], cases.twist[i]]
        below = np.r_[cases.lower[i], cases.twist[i]]
        x[i], _, flag, _ = daqp.solve(
            cases.hessian[i], cases.linear[i], cases.jacobian[i], above, below, _SENSE
        )
        solved[i] = flag > 0
    return QpAnswers(x, solved, len(cases) / (time.perf_counter() - start))


def solve_by_quadprog(cases: QpCases) -> QpAnswers:
    """quadprog's dual active set (Goldfarb and Idnani) in float64; its rows are columns of C'x >= b."""
    x, solved = np.zeros((len(cases), JOINTS)), np.zeros(len(cases), dtype=bool)
    start = time.perf_counter()
    for i in range(len(cases)):
        rows = np.hstack([cases.jacobian[i].T, np.eye(JOINTS), -np.eye(JOINTS)])
        bounds = np.r_[cases.twist[i], cases.lower[i], -cases.upper[i]]
        try:
            x[i] = quadprog.solve_qp(cases.hessian[i], -cases.linear[i], rows, bounds, TASK_ROWS)[0]
            solved[i] = True
        except ValueError:  # how quadprog says that no point is feasible
            pass
    return QpAnswers(x, solved, len(cases) / (time.perf_counter() - start))
