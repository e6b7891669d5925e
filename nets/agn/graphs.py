"""Which anchors see each other: nearest in space, and alike in feature space.

Edges are whole numbers: nothing is differentiated through the choice of neighbours.
"""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from nets.agn.blocks import GROUP

_FAR = 1e12
"""Squared distance of what is not there."""


class Graph(eqx.Module):
    """Edges from every anchor to k others: their indices, and which are real."""

    index: Int[Array, "anchors k"]
    real: Bool[Array, "anchors k"]

    def columns(self, columns) -> "Graph":
        """Some of the edges of each anchor, by number or as a slice."""
        return Graph(self.index[:, columns], self.real[:, columns])


def near(centres: Float[Array, "m 3"], valid: Bool[Array, " m"], count: int, groups: int) -> Graph:
    """The `count` nearest anchors of each in space, itself first, by distance.

    Looked for in the `groups` nearest groups of `GROUP` anchors: among all it would take the square of their
    number.
    """
    blocks = centres.reshape(-1, GROUP, 3)
    real = valid.reshape(-1, GROUP)
    number = jnp.maximum(real.sum(1), 1)[:, None]
    middle = jnp.where(real[..., None], blocks, 0).sum(1) / number
    around, _ = _nearest(_squares(middle[:, None], middle[None]), real.any(1)[None], groups)
    seen = (around[:, :, None] * GROUP + jnp.arange(GROUP)).reshape(len(blocks), -1)
    square = _squares(blocks[:, :, None], centres[seen][:, None]).reshape(len(centres), -1)
    there = jnp.repeat(valid[seen], GROUP, axis=0)
    column, found = _nearest(square, there, count)
    index = jnp.take_along_axis(jnp.repeat(seen, GROUP, axis=0), column, axis=1)
    return Graph(index, found & valid[:, None])


def alike(
    place: Float[Array, "m d"],
    centres: Float[Array, "m 3"],
    normals: Float[Array, "m 3"],
    roughness: Float[Array, " m"],
    noise: Float[Array, " m"],
    valid: Bool[Array, " m"],
    count: int,
) -> Graph:
    """The `count` anchors that are nearest in feature space, one of each group of `GROUP` at most.

    The distance is |f_i - f_j|^2 of the features `place`, plus the squares of how far each one's centre is
    from the other's plane, by the noise there: what lies on one plane is near however far apart. Of each
    group the smoothest anchor stands for all.
    """
    there = jnp.where(valid, roughness, jnp.inf).reshape(-1, GROUP)
    chosen = there.argmin(1) + GROUP * jnp.arange(len(there))
    other, c_other, n_other = place[chosen], centres[chosen], normals[chosen]
    square = (place * place).sum(-1)[:, None] + (other * other).sum(-1) - 2 * place @ other.T
    height = (normals @ c_other.T - (centres * normals).sum(-1)[:, None]) / noise[:, None]
    back = (centres @ n_other.T - (c_other * n_other).sum(-1)) / noise[chosen]
    column, found = _nearest(square + height * height + back * back, valid[chosen][None], count)
    return Graph(chosen[column], found & valid[:, None])


def _nearest(
    square: Float[Array, "m n"], there: Bool[Array, "#m n"], count: int
) -> tuple[Int[Array, "m k"], Bool[Array, "m k"]]:
    """Columns of the `count` smallest of each row, smallest first, and which are real."""
    count = min(count, square.shape[1])
    kept = jax.lax.stop_gradient(jnp.where(there, -square, -_FAR))
    value, column = jax.lax.top_k(kept, count)
    # Behind a barrier: with its result sliced, XLA makes it a whole sort, six times as slow. In another order
    # than it came in: XLA 0.10.2 ends the process where a barrier takes the very pair.
    column, value = jax.lax.optimization_barrier((column, value))
    return column, value > -_FAR


def _squares(a: Float[Array, "*batch 3"], b: Float[Array, "*batch 3"]) -> Float[Array, "*batch"]:
    """Squared distances, differences first: the expanded form cancels in float32."""
    x, y, z = (a[..., axis] - b[..., axis] for axis in range(3))
    return x * x + y * y + z * z
