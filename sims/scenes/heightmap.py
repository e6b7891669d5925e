"""A captured surface as depths on a grid, smooth between the cells."""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int


class HeightMap(eqx.Module):
    """x of a surface over u = -y and v = z, as the quadratic B-spline whose coefficients are the cells.

    The spline has continuous slopes, so normals are continuous, and needs 9 cells a point. Against the depths
    given it smooths by an eighth of their second difference: nothing on surfaces that are flat over a cell.

    depth: coefficients, rows go up, columns to the robot's right [m]. valid: whether the surface was captured
    there. left, low: u and v of the middle of cell (0, 0) [m]. cell: pitch [m].
    """

    depth: Float[Array, "V U"]
    valid: Bool[Array, "V U"]
    left: Float[Array, ""]
    low: Float[Array, ""]
    cell: Float[Array, ""]

    @property
    def lower(self) -> Float[Array, "2"]:
        """Smallest u and v at which the spline is defined [m]."""
        return jnp.stack([self.left, self.low]) + self.cell

    @property
    def upper(self) -> Float[Array, "2"]:
        """Largest u and v at which the spline is defined [m]."""
        rows, columns = self.depth.shape
        return jnp.stack([self.left + (columns - 2) * self.cell, self.low + (rows - 2) * self.cell])

    def inside(self, uv: Float[Array, "2"]) -> Bool[Array, ""]:
        """Whether uv [m] lies on the grid."""
        return jnp.all((uv >= self.lower) & (uv <= self.upper))

    def captured(self, uv: Float[Array, "2"]) -> Bool[Array, ""]:
        """Whether the surface was captured at uv [m]: the nearest cell is valid."""
        return self.holds(self.valid, uv) & self.inside(uv)

    def holds(self, mask: Bool[Array, "V U"], uv: Float[Array, "2"]) -> Bool[Array, ""]:
        """A mask of cells at the one nearest to uv [m]."""
        row, column = self._cell(uv)
        return mask[row, column]

    def nearest(self, uv: Float[Array, "2"]) -> Float[Array, ""]:
        """Depth of the nearest cell [m]: a cheap look before the exact one."""
        row, column = self._cell(uv)
        return self.depth[row, column]

    def evaluate(self, uv: Float[Array, "2"]) -> tuple[Float[Array, ""], Float[Array, "2"]]:
        """Depth [m] and its slopes by u and v. Beyond the grid the nearest point of it counts."""
        uv = jnp.clip(uv, self.lower, self.upper)
        row, column = self._cell(uv)
        patch = jax.lax.dynamic_slice(self.depth, (row - 1, column - 1), (3, 3))
        across = (uv[0] - self.left) / self.cell - column.astype(uv.dtype)
        up = (uv[1] - self.low) / self.cell - row.astype(uv.dtype)
        weight_u, slope_u = spline_weights(across)
        weight_v, slope_v = spline_weights(up)
        along_u = jnp.sum(patch * weight_u[None, :], axis=1)
        bent_u = jnp.sum(patch * slope_u[None, :], axis=1)
        slopes = jnp.stack([jnp.sum(bent_u * weight_v), jnp.sum(along_u * slope_v)]) / self.cell
        return jnp.sum(along_u * weight_v), slopes

    def _cell(self, uv: Float[Array, "2"]) -> tuple[Int[Array, ""], Int[Array, ""]]:
        rows, columns = self.depth.shape
        position = jax.lax.stop_gradient((uv - jnp.stack([self.left, self.low])) / self.cell)
        column = jnp.clip(jnp.round(position[0]), 1, columns - 2).astype(int)
        row = jnp.clip(jnp.round(position[1]), 1, rows - 2).astype(int)
        return row, column


def spline_weights(t: Float[Array, ""]) -> tuple[Float[Array, "3"], Float[Array, "3"]]:
    """Weights of the three nearest coefficients of a quadratic B-spline, and their slopes; |t| <= 1/2."""
    weights = jnp.stack([0.5 * (0.5 - t) ** 2, 0.75 - t**2, 0.5 * (0.5 + t) ** 2])
    return weights, jnp.stack([t - 0.5, -2 * t, t + 0.5])
