"""The quadratic program of the whole-body controller: fixed iterations, implicit gradients."""

from opt.qp.problem import QPSolution, QPStatus, QuadraticProgram
from opt.qp.solve import solve_qp

__all__ = ["QPSolution", "QPStatus", "QuadraticProgram", "solve_qp"]
