"""Sets of quadratic programs, each hard for one reason; all have a point that meets every condition."""

from collections.abc import Callable

import numpy as np

from experiments.benchmarks.qp_loop_peer import JOINTS, TASK_ROWS, QpCases

INEQUALITIES = 12


def plain(rng: np.random.Generator, count: int) -> dict:
    """A point inside of the box, and rows through it."""
    lower = -rng.uniform(0.15, 1.0, size=(count, JOINTS))
    upper = rng.uniform(0.15, 1.0, size=(count, JOINTS))
    jacobian = rng.normal(size=(count, TASK_ROWS, JOINTS)) * np.repeat([1.0, 0.5], [3, 6])
    return {
        "hessian": np.broadcast_to(0.01 * np.eye(JOINTS), (count, JOINTS, JOINTS)).copy(),
        "linear": 0.02 * rng.normal(size=(count, JOINTS)),
        "jacobian": jacobian,
        "point": rng.uniform(0.8 * lower, 0.8 * upper),
        "lower": lower,
        "upper": upper,
        "rows": np.zeros((count, 0, JOINTS)),
    }


def rank_deficient(rng: np.random.Generator, count: int) -> dict:
    """The last task row is a sum of two others."""
    case = plain(rng, count)
    case["jacobian"][:, 5] = case["jacobian"][:, 0] + case["jacobian"][:, 1]
    return case


def near_parallel(rng: np.random.Generator, count: int) -> dict:
    """The last task row differs from the first by a thousandth."""
    case = plain(rng, count)
    case["jacobian"][:, 5] = case["jacobian"][:, 0] + 1e-3 * case["jacobian"][:, 5]
    return case


def narrow(rng: np.random.Generator, count: int) -> dict:
    """Three variables have bounds within 1e-3 of each other."""
    return _pinched(plain(rng, count), 1e-3)


def pinned(rng: np.random.Generator, count: int) -> dict:
    """Three variables have bounds that are equal."""
    return _pinched(plain(rng, count), 0.0)


def _pinched(case: dict, width: float) -> dict:
    for side, share in (("lower", -0.5), ("upper", 0.5)):
        case[side][:, 6:] = case["point"][:, 6:] + share * width
    return case


def stiff(rng: np.random.Generator, count: int) -> dict:
    """M has eigenvalues from 1e-6 to 1, in random directions."""
    case = plain(rng, count)
    turn = np.linalg.qr(rng.normal(size=(count, JOINTS, JOINTS)))[0]
    case["hessian"] = turn * np.geomspace(1e-6, 1.0, JOINTS) @ turn.transpose(0, 2, 1)
    return case


def inequalities(rng: np.random.Generator, count: int) -> dict:
    """12 inequality rows besides, some of them active."""
    case = plain(rng, count)
    case["rows"] = 0.5 * rng.normal(size=(count, INEQUALITIES, JOINTS))
    return case


SETS: dict[str, Callable[[np.random.Generator, int], dict]] = {
    "plain": plain,
    "rank-deficient rows": rank_deficient,
    "near-parallel rows": near_parallel,
    "bounds within 1e-3": narrow,
    "bounds of no width": pinned,
    "M of condition 1e6": stiff,
    "12 inequality rows": inequalities,
}


def draw(name: str, count: int, seed: int) -> QpCases:
    """`count` programs of a set; in float32, so that every solver is given the same numbers."""
    rng = np.random.default_rng(seed)
    case = SETS[name](rng, count)
    point = case.pop("point")
    single = {key: value.astype(np.float32).astype(float) for key, value in case.items()}
    room = rng.uniform(0.01, 0.3, size=single["rows"].shape[:2])
    return QpCases(
        twist=np.einsum("nij,nj->ni", single["jacobian"], point),
        limit=np.einsum("nij,nj->ni", single["rows"], point) + room,
        **single,
    )
