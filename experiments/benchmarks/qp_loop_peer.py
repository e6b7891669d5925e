"""Peer of the batched QP: DAQP and quadprog, one case at a time in a Python loop, as a user would call them.

    minimise  1/2 x'Hx + c'x   subject to   J x = twist,   A x <= limit,   lower <= x <= upper

with 9 joint velocities x, 6 task rows and any number of inequality rows. Needs the extra `bench`.
"""

import dataclasses
import time

import daqp
import numpy as np
import quadprog
from jaxtyping import Bool, Float

JOINTS, TASK_ROWS = 9, 6

# DAQP's marks of its rows: an inequality, and an equality (active 1, and never dropped 4).
_INEQUALITY, _EQUALITY = 0, 5
# What DAQP takes for no bound.
_NO_BOUND = -1e30


@dataclasses.dataclass(frozen=True)
class QpCases:
    """Random problems of the whole-body controller: about 3 % have no solution."""

    hessian: Float[np.ndarray, "cases 9 9"]
    linear: Float[np.ndarray, "cases 9"]
    jacobian: Float[np.ndarray, "cases 6 9"]
    twist: Float[np.ndarray, "cases 6"]
    lower: Float[np.ndarray, "cases 9"]
    upper: Float[np.ndarray, "cases 9"]
    rows: Float[np.ndarray, "cases k 9"]
    limit: Float[np.ndarray, "cases k"]

    def __len__(self) -> int:
        return len(self.linear)

    @property
    def arrays(self) -> tuple[np.ndarray, ...]:
        """M, c, J, v, A, B, lower and upper bounds: what `opt.qp.quadratic_program` takes, in its order."""
        rows = self.rows, self.limit, self.lower, self.upper
        return self.hessian, self.linear, self.jacobian, self.twist, *rows


@dataclasses.dataclass(frozen=True)
class QpAnswers:
    """What a solver found: `x` [rad/s, m/s] holds where `solved`; `rate` is in problems a second."""

    x: Float[np.ndarray, "cases 9"]
    solved: Bool[np.ndarray, " cases"]
    rate: float


def random_cases(count: int, seed: int, inequalities: int = 0) -> QpCases:
    """`count` problems: base columns of unit scale, arm columns of half, twists of 0.15, bounds of 0.15 to 1.

    Inequality rows are of half scale; zero meets them with 0.4 to 1.0 to spare.

    The order of the draws is part of the meaning: it makes one seed give the same problems everywhere.
    """
    rng = np.random.default_rng(seed)
    reach = np.repeat([1.0, 0.5], [3, 6])
    cases = QpCases(
        hessian=np.broadcast_to(0.01 * np.eye(JOINTS), (count, JOINTS, JOINTS)).copy(),
        linear=0.02 * rng.normal(size=(count, JOINTS)),
        jacobian=rng.normal(size=(count, TASK_ROWS, JOINTS)) * reach,
        twist=0.15 * rng.normal(size=(count, TASK_ROWS)),
        lower=-rng.uniform(0.15, 1.0, size=(count, JOINTS)),
        upper=rng.uniform(0.15, 1.0, size=(count, JOINTS)),
        rows=np.zeros((count, 0, JOINTS)),
        limit=np.zeros((count, 0)),
    )
    rows = 0.5 * rng.normal(size=(count, inequalities, JOINTS))
    return dataclasses.replace(cases, rows=rows, limit=rng.uniform(0.4, 1.0, size=(count, inequalities)))


def solve_by_daqp(cases: QpCases) -> QpAnswers:
    """DAQP's dual active set in float64: the reference answer."""
    n, m, k = cases.linear.shape[1], cases.twist.shape[1], cases.limit.shape[1]
    x, solved = np.zeros((len(cases), n)), np.zeros(len(cases), dtype=bool)
    sense = np.array([_INEQUALITY] * n + [_EQUALITY] * m + [_INEQUALITY] * k, dtype=np.int32)
    rows, none = np.concatenate([cases.jacobian, cases.rows], axis=1), np.full(k, _NO_BOUND)
    start = time.perf_counter()
    for i in range(len(cases)):
        above = np.r_[cases.upper[i], cases.twist[i], cases.limit[i]]
        below = np.r_[cases.lower[i], cases.twist[i], none]
        x[i], _, flag, _ = daqp.solve(cases.hessian[i], cases.linear[i], rows[i], above, below, sense)
        solved[i] = flag > 0
    return QpAnswers(x, solved, len(cases) / (time.perf_counter() - start))


def solve_by_quadprog(cases: QpCases) -> QpAnswers:
    """quadprog's dual active set (Goldfarb and Idnani) in float64; its rows are columns of C'x >= b."""
    n, m = cases.linear.shape[1], cases.twist.shape[1]
    x, solved = np.zeros((len(cases), n)), np.zeros(len(cases), dtype=bool)
    start = time.perf_counter()
    for i in range(len(cases)):
        rows = np.hstack([cases.jacobian[i].T, np.eye(n), -np.eye(n), -cases.rows[i].T])
        bounds = np.r_[cases.twist[i], cases.lower[i], -cases.upper[i], -cases.limit[i]]
        try:
            x[i] = quadprog.solve_qp(cases.hessian[i], -cases.linear[i], rows, bounds, m)[0]
            solved[i] = True
        except ValueError:  # how quadprog says that no point is feasible
            pass
    return QpAnswers(x, solved, len(cases) / (time.perf_counter() - start))
