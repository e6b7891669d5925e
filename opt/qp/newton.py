"""The linear system of one Newton step, factored once and solved for several right-hand sides.

All rows, task and inequality, stand on the dual side:

    K dx + G'dl = g          K = M + bound curvature, positive definite
    G dx - D dl = h          D: diagonal, 0 or more (compliance, and distance / multiplier of an inequality)

so dl = S^-1 (G K^-1 g - h) with S = G K^-1 G' + D. An active inequality has D near 0 and an inactive one a
large D; were the inequalities folded into K instead, its entries would grow with the multipliers, and float32
would lose M beside them.
"""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from opt.qp import ldl


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
