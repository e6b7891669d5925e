"""Polynomials over the tangent planes of many neighbourhoods at once."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from jaxpaint.refinement.local_planes import fit_planes, heights, shares

_RIDGE = 1e-5
"""On all coefficients but the constant, in normal equations of order one: a line of points determines few."""


@dataclass(frozen=True)
class Polynomials:
    """Heights f(u, v) over planes, of order 1 or 2: c0 + c1 u + c2 v (+ c3 u^2 + c4 u v + c5 v^2).

    centre: of the planes [m]. axes: unit directions of u, v and the normal. unit: length of u and v [m].
    coefficients: [m].
    """

    centre: Float[np.ndarray, "3 n"]
    axes: Float[np.ndarray, "3 3 n"]
    unit: Float[np.ndarray, "n"]
    coefficients: Float[np.ndarray, "c n"]

    def residuals(self, around: Float[np.ndarray, "3 n k"]) -> Float[np.ndarray, "n k"]:
        """Heights of points over the polynomials [m]."""
        u, v, height = _local(around, self.centre, self.axes, self.unit)
        terms = _terms(u, v, len(self.coefficients))
        return height - sum(c[:, None] * term for c, term in zip(self.coefficients, terms, strict=True))

    def step_from_origin(self) -> tuple[Float[np.ndarray, "3 n"], Float[np.ndarray, "3 n"]]:
        """A Newton step from the origin onto the surface, along its normal [m]; and that normal."""
        origin = np.zeros_like(self.centre)[..., None]
        u, v, _ = (local[:, 0] for local in _local(origin, self.centre, self.axes, self.unit))
        c = self.coefficients
        slope_u, slope_v = c[1], c[2]
        if len(c) == 6:
            slope_u, slope_v = slope_u + 2 * c[3] * u + c[4] * v, slope_v + c[4] * u + 2 * c[5] * v
        slope_u, slope_v = slope_u / self.unit, slope_v / self.unit
        gradient = self.axes[2] - slope_u * self.axes[0] - slope_v * self.axes[1]
        square = 1 + slope_u**2 + slope_v**2
        return -self.residuals(origin)[:, 0] / square * gradient, gradient / np.sqrt(square)


def fit_polynomials(
    around: Float[np.ndarray, "3 n k"],
    weight: Float[np.ndarray, "n k"],
    unit: Float[np.ndarray, "n"],
    order: int,
) -> Polynomials:
    """Weighted least squares of heights over the weighted plane of total least squares.

    unit: about the reach of the weights [m], above zero.
    """
    centre, normal = fit_planes(around, weight)
    axes = np.stack([*_tangents(normal), normal])
    u, v, height = _local(around, centre, axes, unit)
    terms = _terms(u, v, 3 if order == 1 else 6)
    share = shares(weight)
    count = len(terms)
    matrix, right = np.empty((len(u), count, count)), np.empty((len(u), count, 1))
    for i, term in enumerate(terms):
        weighed = share * term
        right[:, i, 0] = np.einsum("nk,nk->n", weighed, height)
        for j, other in enumerate(terms[: i + 1]):
            matrix[:, i, j] = matrix[:, j, i] = np.einsum("nk,nk->n", weighed, other)
    matrix[:, range(1, count), range(1, count)] += _RIDGE
    solved = np.linalg.solve(matrix, right)[..., 0].T
    return Polynomials(centre, axes, unit, np.ascontiguousarray(solved, dtype=around.dtype))


def _local(around, centre, axes, unit):
    """Coordinates u, v in units of `unit` and the height [m]."""
    u, v, height = (heights(around, centre, axis) for axis in axes)
    return u / unit[:, None], v / unit[:, None], height


def _terms(u, v, count):
    return [np.ones_like(u), u, v] if count == 3 else [np.ones_like(u), u, v, u * u, u * v, v * v]


def _tangents(normal: Float[np.ndarray, "3 n"]) -> tuple[np.ndarray, np.ndarray]:
    """Two unit vectors across each normal and each other, without a case (Duff et al., 2017)."""
    x, y, z = normal
    sign = np.where(z >= 0, 1, -1).astype(normal.dtype)
    a = -1 / (sign + z)
    b = x * y * a
    return np.stack([1 + sign * x * x * a, sign * b, -sign * x]), np.stack([b, sign + y * y * a, -y])
