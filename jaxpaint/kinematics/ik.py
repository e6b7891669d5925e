"""Inverse kinematics: joint positions that put the tool at a pose, by damped least squares."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from jaxpaint.kinematics.chain import KinematicChain, forward, jacobian
from jaxpaint.kinematics.pose import Pose
from jaxpaint.kinematics.rotations import compose, rotate, swing_twist, transpose
from jaxpaint.kinematics.small_solve import gram, solve_spd


class IKSettings(eqx.Module):
    """What counts as error, and when it is small enough.

    spin_weight: how much the turn about the tool's axis counts, 1 for the full pose and 0 for position and
    axis alone. damping: least damping of a step. position_tolerance [m], orientation_tolerance [rad]: a
    solution within both has converged. iterations: steps taken from each start.
    """

    spin_weight: float | Float[Array, ""] = 1.0
    damping: float | Float[Array, ""] = 1e-5
    position_tolerance: float | Float[Array, ""] = 1e-4
    orientation_tolerance: float | Float[Array, ""] = 1e-3
    iterations: int = eqx.field(static=True, default=30)


class IKSolution(eqx.Module):
    """Joint positions, and how well they do.

    q: within their limits. position_error [m]; orientation_error [rad], the turn about the tool's axis
    counted as much as `spin_weight` says. converged: whether both are within tolerance.
    """

    q: Float[Array, " joints"]
    position_error: Float[Array, ""]
    orientation_error: Float[Array, ""]
    converged: Bool[Array, ""]


def solve(
    chain: KinematicChain,
    starts: Float[Array, "starts joints"],
    target: Pose,
    lower: Float[Array, " joints"],
    upper: Float[Array, " joints"],
    settings: IKSettings | None = None,
) -> IKSolution:
    """The best solution: of those that converged the nearest to the first start, else the least error.

    For an arm on a parked base, pass `arm_chain(chain, q_base)`; a whole chain moves the base as well.
    """
    settings = IKSettings() if settings is None else settings
    tries = jax.vmap(lambda q: _descend(chain, q, target, lower, upper, settings))(starts)
    away = jnp.abs(tries.q - starts[0]).max(-1)
    error = tries.position_error + tries.orientation_error
    far = 1e3  # any solution is better than none
    best = jnp.argmin(
        jnp.where(tries.converged, away, far * (1 + jnp.where(jnp.isfinite(error), error, far)))
    )
    return jax.tree.map(lambda x: x[best], tries)


def spread_starts(
    home: Float[Array, " joints"],
    lower: Float[Array, " joints"],
    upper: Float[Array, " joints"],
    *,
    count: int,
    reach: float = np.pi,
) -> Float[Array, "starts joints"]:
    """`home` and evenly spread joint positions within `reach` [rad] of it and within the limits.

    The additive recurrence of the generalised golden ratio: evenly spread at any count, the same in every
    run.
    """
    root = 2.0
    for _ in range(50):  # the fixed point of x = (1 + x)^(1 / (n + 1))
        root = (1 + root) ** (1 / (home.shape[0] + 1))
    share = np.arange(count)[:, None] * root ** -np.arange(1.0, home.shape[0] + 1) % 1.0
    low, high = jnp.maximum(home - reach, lower), jnp.minimum(home + reach, upper)
    spread = low + jnp.asarray(share, home.dtype) * (high - low)
    return spread.at[0].set(home)


def _descend(chain, q, target, lower, upper, settings) -> IKSolution:
    """Levenberg-Marquardt with Sugihara's damping, the squared error itself: it converges like Newton."""

    def step(q, _):
        pose, J = jacobian(chain, q)
        error, J = _weigh(pose, J, target, settings)
        damping = settings.damping + 0.5 * (error * error).sum()
        A = gram(J.T) + damping * jnp.eye(chain.size, dtype=q.dtype)
        g = (J * error[:, None]).sum(0)
        # a joint that rests on its limit and would leave it takes no part in this step
        held = ((q <= lower) & (g < 0)) | ((q >= upper) & (g > 0))
        free = jnp.where(held, 0, 1).astype(q.dtype)
        A = A * free[:, None] * free[None, :] + jnp.diag(1 - free)
        change, _ = solve_spd(A, (g * free)[:, None])
        return jnp.clip(q + change[:, 0], lower, upper), None

    q, _ = jax.lax.scan(step, jnp.clip(q, lower, upper), None, length=settings.iterations)
    return _judge(q, forward(chain, q), target, settings)


def _error(pose: Pose, target: Pose, settings: IKSettings):
    """Offset of the target [m] and the rotation to it [rad], both in the tool's axes."""
    R = transpose(pose.R)
    turn = swing_twist(compose(R, target.R))
    weights = jnp.stack(
        [jnp.ones_like(turn[0]), jnp.ones_like(turn[0]), settings.spin_weight * jnp.ones_like(turn[0])]
    )
    return rotate(R, target.p - pose.p), turn * weights


def _weigh(pose: Pose, J, target: Pose, settings: IKSettings):
    """The error and its Jacobian with respect to the joints, negated, in the tool's axes."""
    offset, turn = _error(pose, target, settings)
    to_tool = transpose(pose.R)
    linear, angular = _turned(to_tool, J[:3]), _turned(to_tool, J[3:])
    angular = jnp.concatenate([angular[:2], settings.spin_weight * angular[2:]])
    return jnp.concatenate([offset, turn]), jnp.concatenate([linear, angular])


def _turned(R, columns):
    return R[:, :1] * columns[:1] + R[:, 1:2] * columns[1:2] + R[:, 2:] * columns[2:]


def _judge(q, pose: Pose, target: Pose, settings: IKSettings) -> IKSolution:
    offset, turn = _error(pose, target, settings)
    position, orientation = jnp.sqrt((offset * offset).sum()), jnp.sqrt((turn * turn).sum())
    good = (position <= settings.position_tolerance) & (orientation <= settings.orientation_tolerance)
    return IKSolution(q, position, orientation, good)
