"""Quadratic programs of the whole-body controller: an interior point with implicit gradients."""

from opt.qp.problem import Duals, QPSolution, QPStatus, QuadraticProgram, Residuals, quadratic_program
from opt.qp.solve import SOLUTION, solve_qp

__all__ = [
    "SOLUTION",
    "Duals",
    "QPSolution",
    "QPStatus",
    "QuadraticProgram",
    "Residuals",
    "quadratic_program",
    "solve_qp",
]
