"""Chamfer distances between a cloud and a sampled surface: for gradients, and for clouds of millions.

S1-(1) is CD_2(P, Q) = 1/|P| sum_x min_y |x - y|^2 + 1/|Q| sum_y min_x |y - x|^2, in m^2. S1's table II counts
in "(1e-3)" and names the norms L1 and L2; its body is not in the copies at hand, nor how L1 is taken. Two
conventions are in use, with m(P, Q) = 1/|P| sum_x min_y |x - y| in m: the sum m(P, Q) + m(Q, P), which is
S1-(1) without the squares (`Chamfer.l1_sum`), and half of it, as in PCN (`Chamfer.l1`).
"""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, ArrayLike, Bool, Float
from scipy.spatial import cKDTree

# Points of the cloud at once: what a cache holds of their distances to all samples.
_BLOCK = 128
# Points that ask the tree at once: it answers in 16 bytes each.
_QUERIES = 1_048_576


class Chamfer(eqx.Module):
    """Two-way distances between point sets: l1 [m] (half of the sum of both means), l2 [m^2] (S1-(1))."""

    l1: Float[ArrayLike, ""]
    l2: Float[ArrayLike, ""]

    @property
    def l1_sum(self) -> Float[ArrayLike, ""]:
        """The other convention of L1: the sum of both means [m]."""
        return 2 * self.l1


def chamfer(
    cloud: Float[Array, "points 3"], valid: Bool[Array, "points"], truth: Float[Array, "samples 3"]
) -> Chamfer:
    """Chamfer distances between the valid points of a cloud P and a sampled surface Q.

    l2 is S1-(1): mean over P of the squared distance to the nearest of Q, plus the same from Q to P. l1 takes
    plain distances and halves the sum, as PCN does. Without valid points both are infinite. Blockwise: no
    array of points x samples is ever made.
    """
    to_truth, to_cloud = _nearest_squares(cloud, valid, truth)
    count = valid.sum(dtype=to_truth.dtype)
    there = jnp.where(valid, to_truth, 0)
    some = count > 0
    count = jnp.where(some, count, 1)
    l2 = there.sum() / count + to_cloud.mean()
    l1 = 0.5 * (_root(there).sum() / count + _root(to_cloud).mean())
    return Chamfer(l1=jnp.where(some, l1, jnp.inf), l2=jnp.where(some, l2, jnp.inf))


def chamfer_by_tree(cloud: Float[np.ndarray, "points 3"], truth: Float[np.ndarray, "samples 3"]) -> Chamfer:
    """The same figures in doubles by k-d trees on the host, without gradients, for clouds of any size.

    Infinite without points in the cloud. Raises ValueError without samples of the truth.
    """
    if len(truth) == 0:
        raise ValueError("truth: no samples found, at least 1 is needed")
    if len(cloud) == 0:
        return Chamfer(l1=np.float64(np.inf), l2=np.float64(np.inf))
    there, back = _distances(cloud, truth), _distances(truth, cloud)
    return Chamfer(l1=0.5 * (there.mean() + back.mean()), l2=(there**2).mean() + (back**2).mean())


def _distances(points: Float[np.ndarray, "n 3"], others: Float[np.ndarray, "m 3"]) -> np.ndarray:
    tree = cKDTree(others)
    pieces = range(0, len(points), _QUERIES)
    return np.concatenate([tree.query(points[i : i + _QUERIES], workers=-1)[0] for i in pieces])


def _nearest_squares(cloud, valid, truth):
    """Squared distance from each cloud point to the truth and from each truth point to the cloud [m^2].

    Differences first, squares then: the expanded form p^2 - 2 p q + q^2 loses millimetres in float32.
    """
    size = -(-len(cloud) // _BLOCK) * _BLOCK
    missing = size - len(cloud)
    blocks = jnp.pad(cloud, ((0, missing), (0, 0))).reshape(-1, _BLOCK, 3)
    there = jnp.pad(valid, (0, missing)).reshape(-1, _BLOCK)

    def visit(best, block):
        points, real = block
        dx, dy, dz = (points[:, None, axis] - truth[None, :, axis] for axis in range(3))
        squares = dx * dx + dy * dy + dz * dz
        nearest = jnp.where(real[:, None], squares, jnp.inf).min(0)
        return jnp.minimum(best, nearest), squares.min(1)

    start = jnp.full(len(truth), jnp.inf, cloud.dtype)
    to_cloud, to_truth = jax.lax.scan(jax.checkpoint(visit), start, (blocks, there))
    return to_truth.reshape(-1)[: len(cloud)], to_cloud


def _root(squares: Float[Array, "n"]) -> Float[Array, "n"]:
    """Square root with gradient 0 at 0 (double where), where points coincide."""
    positive = squares > 0
    return jnp.where(positive, jnp.sqrt(jnp.where(positive, squares, 1)), 0)
