"""Which controller gets a list of poses: the adaptive control policy's mode detection, S1-(5) to (7)."""

from typing import Literal

import equinox as eqx
import jax
import jax.numpy as jnp
import jaxlie
from jaxtyping import Array, Bool, Float, Int

from jaxpaint.decisions.relax import exceeds
from jaxpaint.decisions.thresholds import Thresholds

Statistic = Literal["deviation", "range", "literal"]

CLUSTER = 4
"""Poses for each cluster: K of S1-(5) is the number of poses over this, rounded up."""
SMALLEST = 2
"""Clusters with fewer poses have no directions and are left out of S1-(7)."""
_ROUNDS = 8
"""Lloyd iterations."""
_SIZE = 6
"""Numbers in a pose: position and rotation vector."""


class ModeSettings(eqx.Module):
    """Numbers of the mode detection; all traced; chosen on 600 labelled lists of their own.

    rotation_weight: metres that one radian counts in a pose vector [m/rad].
    tolerance: poses closer than about this are parts of one motion [m].
    gap: how far from a pose, in spacings of its cluster, nothing is known of what lies between the poses [-].
    """

    rotation_weight: Float[Array, ""] = eqx.field(default=0.2, converter=jnp.asarray)
    tolerance: Float[Array, ""] = eqx.field(default=0.02, converter=jnp.asarray)
    gap: Float[Array, ""] = eqx.field(default=0.3, converter=jnp.asarray)


class Decision(eqx.Module):
    """What was decided and why.

    whole_body: 1 for a path, which goes to the whole-body controller, 0 for independent waypoints, which go
    to the trajectory controller; between the two at a temperature above 0. statistic: S1-(7). clusters:
    S1-(6) of each cluster. counted: which clusters are in the mean. number: poses in each cluster.
    """

    whole_body: Float[Array, ""]
    statistic: Float[Array, ""]
    clusters: Float[Array, "K"]
    counted: Bool[Array, "K"]
    number: Float[Array, "K"]


def decide(
    position: Float[Array, "N 3"],
    rotation: Float[Array, "N 3 3"],
    mask: Bool[Array, "N"],
    thresholds: Thresholds,
    settings: ModeSettings | None = None,
    *,
    statistic: Statistic = "deviation",
) -> Decision:
    """Independent waypoints, or a path? K-means over the poses, S1-(5); variance ratios of each cluster's
    principal components and how much they differ, S1-(6); the mean over the clusters, S1-(7); waypoints
    inside the band.

    position in the map frame [m]; rotation as matrices; mask: which of the N poses there are.

    S1-(6) as printed is "literal": the standard deviation of ratios that sum to one, at most 0.373 for six of
    them, so that S1's upper bound 0.8 is out of reach. "deviation" is that over its maximum, "range" is PC_1
    - PC_n; both reach from 0 (no direction stands out) to 1 (a line). To these two we add a variance in all
    directions, because without it three views in a row are a line like any stroke, and no scale tells them
    apart:
    - the square of `tolerance`: poses much closer than that are one motion. Dense paths come out near 0, S1's
      "very small" differences; a straight row of poses passes the lower bound at a spacing of about 30 mm;
    - the square of `gap` times the spacing of a cluster of that many poses: a line through few poses far
      apart is no evidence for a line. Waypoints come out inside the band, in rows as well as on grids.
    A list with no cluster to count, such as a single pose, is waypoints: its statistic is the middle of the
    band. Memory grows with N^2 / 4.
    """
    settings = settings or ModeSettings()
    poses = pose_vectors(position, rotation, mask, settings.rotation_weight)
    number, covariance = _covariances(poses, mask)
    if statistic != "literal":
        covariance = _with_room(covariance, number, settings)
    clusters = _STATISTICS[statistic](covariance)
    counted = (number >= SMALLEST) & (_trace(covariance) > 0)
    total = jnp.sum(counted)
    middle = (thresholds.variance_lower + thresholds.variance_upper) / 2
    mean = jnp.where(total > 0, jnp.sum(jnp.where(counted, clusters, 0)) / jnp.maximum(total, 1), middle)
    heat = thresholds.mode_temperature
    above = exceeds(mean, thresholds.variance_lower, heat)
    beyond = exceeds(mean, thresholds.variance_upper, heat)
    return Decision(1 - above * (1 - beyond), mean, clusters, counted, number)


def pose_vectors(
    position: Float[Array, "N 3"],
    rotation: Float[Array, "N 3 3"],
    mask: Bool[Array, "N"],
    weight: Float[Array, ""],
) -> Float[Array, "N 6"]:
    """Position [m] and weighted rotation vector [m] of each pose, relative to the first one; 0 where there is
    none.

    Relative, because the rotation vector jumps where the turn passes pi.
    """
    first = jnp.argmax(mask)
    ahead = jnp.where(mask[:, None], position - position[first], 0)
    same = jnp.eye(3, dtype=rotation.dtype)
    turned = jnp.sum(rotation[first][:, :, None] * rotation[:, :, None, :], axis=1)  # R_first^T R
    turned = jnp.where(mask[:, None, None], turned, same)
    vector = jax.vmap(lambda matrix: jaxlie.SO3.from_matrix(matrix).log())(turned)
    return jnp.concatenate([ahead, weight * vector], axis=-1)


def _covariances(
    poses: Float[Array, "N 6"], mask: Bool[Array, "N"]
) -> tuple[Float[Array, "K"], Float[Array, "K 6 6"]]:
    """Number of poses in each cluster, and their covariance."""
    label, k = k_means(poses, mask)
    number, centre = _centres(poses, label, mask, k)
    local = poses - centre[label]
    outer = jnp.where(mask[:, None, None], local[:, :, None] * local[:, None, :], 0)
    total = jnp.zeros((k, _SIZE, _SIZE), poses.dtype).at[label].add(outer)
    return number, total / jnp.maximum(number, 1)[:, None, None]


def _with_room(
    covariance: Float[Array, "K 6 6"], number: Float[Array, "K"], settings: ModeSettings
) -> Float[Array, "K 6 6"]:
    """The covariances with the variance in all directions that `decide` speaks of."""
    # n poses in a row, one spacing apart, have the variance spacing^2 (n^2 - 1) / 12
    spacing_squared = 12 * _trace(covariance) / jnp.maximum(jnp.square(number) - 1, 1)
    room = jnp.square(settings.tolerance) + jnp.square(settings.gap) * spacing_squared
    return covariance + room[:, None, None] * jnp.eye(_SIZE, dtype=covariance.dtype)


def _deviation(covariance: Float[Array, "K 6 6"]) -> Float[Array, "K"]:
    """Standard deviation of the variance ratios over its maximum, sqrt(5) / 6.

    From traces alone, as the ratios' mean is 1/6 and their squares sum to tr(C^2) / tr(C)^2: no eigenvalues,
    and gradients wherever the ratios are not all equal.
    """
    trace = _trace(covariance)
    squares = jnp.sum(covariance * covariance, axis=(1, 2)) / jnp.square(jnp.where(trace > 0, trace, 1))
    excess = (_SIZE * squares - 1) / (_SIZE - 1)
    some = excess > 0
    # where twice: the root of zero has no gradient, and NaN times zero is NaN
    return jnp.where(some, jnp.sqrt(jnp.where(some, excess, 1)), 0)


def _literal(covariance: Float[Array, "K 6 6"]) -> Float[Array, "K"]:
    return _deviation(covariance) * (_SIZE - 1) ** 0.5 / _SIZE


def _range(covariance: Float[Array, "K 6 6"]) -> Float[Array, "K"]:
    """PC_1 - PC_n."""
    components, trace = jnp.linalg.eigvalsh(covariance), _trace(covariance)
    return (components[:, -1] - components[:, 0]) / jnp.where(trace > 0, trace, 1)


_STATISTICS = {"deviation": _deviation, "range": _range, "literal": _literal}


def _trace(covariance: Float[Array, "K 6 6"]) -> Float[Array, "K"]:
    return jnp.trace(covariance, axis1=1, axis2=2)


def k_means(poses: Float[Array, "N 6"], mask: Bool[Array, "N"]) -> tuple[Int[Array, "N"], int]:
    """Cluster of each pose by Lloyd's iterations on S1-(5), and the largest number of clusters.

    Deterministic: it starts from stretches of `CLUSTER` poses in their order.
    """
    k = -(-mask.shape[0] // CLUSTER)
    rank = jnp.cumsum(mask) - 1
    live = -(-jnp.sum(mask) // CLUSTER)
    label = jnp.where(mask, rank * live // jnp.maximum(jnp.sum(mask), 1), 0)

    def iterate(_, label):
        number, centre = _centres(poses, label, mask, k)
        squares = jnp.sum(centre * centre, axis=-1) - 2 * poses @ centre.T
        return jnp.argmin(jnp.where(number > 0, squares, jnp.inf), axis=-1)

    return jax.lax.fori_loop(0, _ROUNDS, iterate, label), k


def _centres(poses, label, mask, k: int) -> tuple[Float[Array, "K"], Float[Array, "K 6"]]:
    """Number of poses in each cluster, and their mean."""
    weight = mask.astype(poses.dtype)
    number = jnp.zeros(k, poses.dtype).at[label].add(weight)
    total = jnp.zeros((k, _SIZE), poses.dtype).at[label].add(weight[:, None] * poses)
    return number, total / jnp.maximum(number, 1)[:, None]
