"""The linear system of one Newton step, factored once and solved for several right-hand sides.

All rows, task and inequality, stand on the dual side:

    K dx + G'dl = g          K = M + bound curvature, positive definite
    G dx - D dl = h          D: diagonal, 0 or more (compliance, and distance / multiplier of an inequality)

so dl = S^-1 (G K^-1 g - h) with S = G K^-1 G' + D. An active inequality has D near 0 and an inactive one a
large D; were the inequalities folded into K as they are, its entries would grow with the multipliers, and
float32 would lose M beside them. Where there are more inequalities than variables S is the larger matrix, and
they are folded after all (`folded_system`), with a D that is not let near 0: a step is then proximal in their
multipliers, with the same fixed point.
"""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from opt.qp import ldl

# Of a row a that is folded: the least D, as share of a K^-1 a'. With 1e-3 three of 4,000 random cases do not
# converge in float32; with 1e-4 and with this all do, to the same solutions.
_LEAST_FOLDED = 2e-5


class Metric(NamedTuple):
    """K, as the inverse of its diagonal or as factors."""

    inverse: Float[Array, "n"] | None
    factors: ldl.LDL | None

    def solve(self, right: Float[Array, "n"]) -> Float[Array, "n"]:
        """K^-1 right."""
        if self.inverse is not None:
            return self.inverse * right
        assert self.factors is not None
        return ldl.solve(self.factors, right)


class NewtonSystem(NamedTuple):
    """K, G and the factors of S."""

    metric: Metric
    rows: Float[Array, "r n"]
    schur: ldl.LDL

    def solve(self, g: Float[Array, "n"], h: Float[Array, "r"]) -> tuple[Array, Array]:
        """dx and dl."""
        first = self.metric.solve(g)
        dl = ldl.solve(self.schur, (self.rows * first).sum(1) - h)
        if self.metric.inverse is not None:
            return first - self.metric.inverse * (self.rows * dl[:, None]).sum(0), dl
        return self.metric.solve(g - (self.rows * dl[:, None]).sum(0)), dl


class FoldedSystem(NamedTuple):
    """K + A'D^-1 A of the inequality rows A, and the factors of the task rows' S.

    halves: L^-1 J' with the factors L of the former.
    """

    metric: ldl.LDL
    tasks: Float[Array, "m n"]
    rows: Float[Array, "k n"]
    weight: Float[Array, "k"]
    halves: Float[Array, "n m"]
    schur: ldl.LDL

    def solve(self, g: Float[Array, "n"], h: Float[Array, "r"]) -> tuple[Array, Array]:
        """dx and dl."""
        m = self.tasks.shape[0]
        told = self.weight * h[m:]
        half = ldl.solve_lower(self.metric, g + (self.rows * told[:, None]).sum(0))
        dl = h[:m]
        if m:
            scaled = half * jnp.stack(self.metric.inverse)
            dl = ldl.solve(self.schur, (self.halves * scaled[:, None]).sum(0) - h[:m])
            half = half - (self.halves * dl).sum(1)
        dx = ldl.solve_upper(self.metric, half)
        return dx, jnp.concatenate([dl, self.weight * (self.rows * dx).sum(1) - told])


def folded_system(
    hessian: Float[Array, "n"] | Float[Array, "n n"],
    curvature: Float[Array, "n"],
    rows: Float[Array, "r n"],
    diagonal: Float[Array, "r"],
    tasks: int,
    regular: float,
) -> FoldedSystem:
    """The same system with the rows after the first `tasks` folded into K."""
    J, A = rows[:tasks], rows[tasks:]
    size = curvature + (hessian if hessian.ndim == 1 else jnp.diagonal(hessian))
    weight = 1 / jnp.maximum(diagonal[tasks:], _LEAST_FOLDED * (A * A / size).sum(1))
    columns = ldl.weighted_gram(A.T, weight)
    if hessian.ndim == 2:
        columns = [column + hessian[j:, j] for j, column in enumerate(columns)]
    metric = ldl.factor(columns, size if hessian.ndim == 1 else curvature)
    halves = ldl.solve_lower(metric, J.T)
    gram = ldl.weighted_gram(halves.T, jnp.stack(metric.inverse))
    mean = sum(column[0] for column in gram) / max(len(gram), 1)
    return FoldedSystem(metric, J, A, weight, halves, ldl.factor(gram, diagonal[:tasks] + regular * mean))


def newton_system(
    hessian: Float[Array, "n"] | Float[Array, "n n"],
    curvature: Float[Array, "n"],
    rows: Float[Array, "r n"],
    diagonal: Float[Array, "r"],
    regular: float,
) -> NewtonSystem:
    """Factors the system. regular: share of S's mean diagonal that is added to D, so that dependent rows
    are no division by zero; a step is then proximal in these multipliers, and its fixed point the same.
    """
    if hessian.ndim == 1:
        inverse = 1 / (hessian + curvature)
        metric, gram = Metric(inverse, None), ldl.weighted_gram(rows, inverse)
    else:
        n = curvature.shape[0]
        size = jnp.trace(hessian) / n
        factors = ldl.factor([hessian[j:, j] for j in range(n)], curvature + 1e-7 * size)
        halves = ldl.solve_lower(factors, rows.T)
        metric, gram = Metric(None, factors), ldl.weighted_gram(halves.T, jnp.stack(factors.inverse))
    mean = sum(column[0] for column in gram) / max(len(gram), 1)
    return NewtonSystem(metric, rows, ldl.factor(gram, diagonal + regular * mean))
