import importlib.util

import numpy as np
import pytest

pytest.importorskip("daqp", reason="needs the extra `bench`")
pytest.importorskip("quadprog", reason="needs the extra `bench`")

from experiments.benchmarks.qp_loop_peer import QpCases, random_cases, solve_by_daqp, solve_by_quadprog


@pytest.fixture(scope="module")
def cases() -> QpCases:
    return random_cases(300, seed=3)


def test_both_solvers_find_the_same_feasible_minimum(cases: QpCases):
    daqp, quadprog = solve_by_daqp(cases), solve_by_quadprog(cases)
    np.testing.assert_array_equal(daqp.solved, quadprog.solved)
    assert 0.9 < daqp.solved.mean() < 1.0  # some have no solution, and both say so
    x = daqp.x[daqp.solved]
    np.testing.assert_allclose(x, quadprog.x[daqp.solved], atol=1e-6)
    reached = np.einsum("nij,nj->ni", cases.jacobian[daqp.solved], x)
    np.testing.assert_allclose(reached, cases.twist[daqp.solved], atol=1e-6)
    assert np.all(x >= cases.lower[daqp.solved] - 1e-6)
    assert np.all(x <= cases.upper[daqp.solved] + 1e-6)


def test_a_seed_names_its_cases():
    again, other = random_cases(5, seed=3), random_cases(5, seed=4)
    np.testing.assert_array_equal(random_cases(5, seed=3).jacobian, again.jacobian)
    assert np.all(again.jacobian != other.jacobian)


@pytest.mark.realdata
def test_cases_and_answers_are_those_of_the_reference_script(shared_peers, cases: QpCases):
    spec = importlib.util.spec_from_file_location("reference_qp_loop", shared_peers / "qp_loop.py")
    assert spec is not None
    assert spec.loader is not None
    reference = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(reference)

    theirs = reference.cases(len(cases), 3)
    ours = [cases.hessian, cases.linear, cases.jacobian, cases.twist, cases.lower, cases.upper]
    for name, array in zip(["M", "c", "J", "v", "lb", "ub"], ours, strict=True):
        np.testing.assert_array_equal(theirs[name], array)
    answers, solved, _ = reference.solve_daqp(theirs)
    mine = solve_by_daqp(cases)
    np.testing.assert_array_equal(solved, mine.solved)
    np.testing.assert_allclose(answers[solved], mine.x[solved], atol=1e-9)
