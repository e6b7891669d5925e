"""An extended Kalman filter for the base's pose in the plane: odometry between looks, evidence at looks."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.kinematics.rotations import compose, rotate
from jaxpaint.localisation.evidence import Evidence
from jaxpaint.localisation.factors import backward_solve, cholesky, forward_solve


class Belief(eqx.Module):
    """pose: (x, y [m], yaw [rad]) of the base in the map; yaw is continuous and not wrapped.

    covariance: of true - believed, in the map frame; symmetric, not negative.
    """

    pose: Float[Array, "3"]
    covariance: Float[Array, "3 3"]


class DriftModel(eqx.Module):
    """Variances by which odometry's errors grow; all traced.

    along, across: the way travelled [m^2/m]; yaw: of the heading per metre [rad^2/m]. turn_position
    [m^2/rad], turn_yaw [rad^2/rad]: per radian that the base rotated. steer_position [m^2/rad], steer_yaw
    [rad^2/rad]: per radian that loaded wheels steered.

    A wheel's slip is in truth a constant share q of the travel, so its error grows with travel, not with the
    root of travel. White noise with q^2 S m^2/m has the same variance after a way S, less after a longer
    one: choose S about the longest way between looks that see that direction. The defaults are for S = 1 m
    and 0.3 % of travel, 0.3 % of rotation, 0.04 deg/m.
    """

    along: Float[Array, ""] = eqx.field(default=1e-5, converter=jnp.asarray)
    across: Float[Array, ""] = eqx.field(default=1e-6, converter=jnp.asarray)
    yaw: Float[Array, ""] = eqx.field(default=8e-7, converter=jnp.asarray)
    turn_position: Float[Array, ""] = eqx.field(default=1e-8, converter=jnp.asarray)
    turn_yaw: Float[Array, ""] = eqx.field(default=1e-5, converter=jnp.asarray)
    steer_position: Float[Array, ""] = eqx.field(default=1e-7, converter=jnp.asarray)
    steer_yaw: Float[Array, ""] = eqx.field(default=1e-7, converter=jnp.asarray)


class Trust(eqx.Module):
    """When evidence is refused; all traced.

    surprise: a correction may be this many standard deviations of the belief, squared and summed over the
    three directions; 16.3 is exceeded once in 1,000 rightful corrections at most. widening: the covariance
    grows by this factor when evidence is refused.
    """

    surprise: Float[Array, ""] = eqx.field(default=16.3, converter=jnp.asarray)
    widening: Float[Array, ""] = eqx.field(default=2.0, converter=jnp.asarray)


def predict(
    belief: Belief, motion: Float[Array, "3"], steered: Float[Array, ""], drift: DriftModel | None = None
) -> Belief:
    """The belief after a motion that odometry measured.

    motion: displacement (x, y [m], yaw [rad]) in the base frame, followed at the mean heading. steered: mean
    angle that loaded wheels steered [rad].
    """
    yaw = belief.pose[2] + motion[2] / 2
    c, s = jnp.cos(yaw), jnp.sin(yaw)
    dx, dy = c * motion[0] - s * motion[1], s * motion[0] + c * motion[1]
    pose = belief.pose + jnp.stack([dx, dy, motion[2]])
    noise = _drifted(motion, steered, drift or DriftModel())
    one, zero = jnp.ones_like(c), jnp.zeros_like(c)
    F = jnp.stack([jnp.stack([one, zero, -dy]), jnp.stack([zero, one, dx]), jnp.stack([zero, zero, one])])
    G = jnp.stack([jnp.stack([c, -s, -dy / 2]), jnp.stack([s, c, dx / 2]), jnp.stack([zero, zero, one])])
    return Belief(pose, _carried(F, belief.covariance) + _carried(G, noise))


def correct(belief: Belief, evidence: Evidence, trust: Trust | None = None) -> Belief:
    """The belief after a look at the believed pose.

    With P = L L^T and S = 1 + L^T I L the covariance is L S^-1 L^T = (P^-1 + I)^-1 and the correction is that
    times the vector: S has no eigenvalue below 1, whichever of P and I is singular, so float32 suffices.

    A wrong match must not throw the robot: evidence that would move the pose by more than `trust.surprise`
    is refused as a whole, and the covariance widened instead. One wrong look moves nothing; a robot that was
    really displaced is believed after a few looks that agree. Evidence that is empty or not finite changes
    nothing at all.
    """
    t = trust or Trust()
    sound = _finite(belief.pose) & _finite(belief.covariance)
    usable = (evidence.used > 0) & _finite(evidence.information) & _finite(evidence.vector) & sound
    moved, covariance, square = _corrected(
        jnp.where(usable, belief.covariance, 0),
        jnp.where(usable, evidence.information, 0),
        jnp.where(usable, evidence.vector, 0),
    )
    taken = usable & (square <= t.surprise)
    widened = jnp.where(usable, t.widening, 1) * belief.covariance
    return Belief(belief.pose + jnp.where(taken, moved, 0), jnp.where(taken, covariance, widened))


def surprise(belief: Belief, evidence: Evidence) -> Float[Array, ""]:
    """How far evidence would move the belief: squared standard deviations of the belief itself, summed.

    At most a chi-squared variable of 3 degrees of freedom while both are right; less where the evidence is
    weak. What `Trust` is about.
    """
    return _corrected(belief.covariance, evidence.information, evidence.vector)[2]


def _corrected(P, information, vector):
    """The move, the covariance after it, and the move's square in standard deviations of P."""
    L = cholesky(P, 0.0)
    eye = jnp.eye(3, dtype=P.dtype)
    C = cholesky(eye + _carried(L.T, information), 1.0)  # S = C C^T
    half = forward_solve(C, jnp.concatenate([L.T, rotate(L.T, vector)[:, None]], axis=1))
    root, pulled = half[:, :3], half[:, 3:]
    steps = backward_solve(C, pulled)[:, 0]
    return rotate(L, steps), _carried(root.T, eye), (steps * steps).sum()


def _carried(A, P):
    """A P A^T, exactly symmetric."""
    product = compose(compose(A, P), A.T)
    return (product + product.T) / 2


def _drifted(motion, steered, d: DriftModel):
    """Covariance of what odometry is off by in one motion, in the base frame."""
    x, y, turned = motion[0], motion[1], jnp.abs(motion[2])
    square = x * x + y * y
    some = square > 0  # the root's gradient is infinite at 0, and no way has no direction
    way = jnp.where(some, jnp.sqrt(jnp.where(some, square, 1)), 0)
    per = 1 / jnp.where(some, way, 1)
    wheels = jnp.abs(steered)
    same = d.across * way + d.turn_position * turned + d.steer_position * wheels
    more = (d.along - d.across) * per
    yaw = d.yaw * way + d.turn_yaw * turned + d.steer_yaw * wheels
    zero = jnp.zeros_like(yaw)
    return jnp.stack(
        [
            jnp.stack([same + more * x * x, more * x * y, zero]),
            jnp.stack([more * x * y, same + more * y * y, zero]),
            jnp.stack([zero, zero, yaw]),
        ]
    )


def _finite(x):
    return jnp.isfinite(x).all()
