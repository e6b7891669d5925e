"""Postures for a pose of the tool in which the robot does not touch itself."""

from collections.abc import Callable

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from jaxpaint.kinematics.chain import KinematicChain
from jaxpaint.kinematics.ik import IKSolution, solve
from jaxpaint.kinematics.pose import Pose

OWN_ROOM = 0.02
"""Spheres are fatter than the robot: one whose gap to itself is as large as this is clear, and can be left
again [m]."""

# What is worse than any way of the joints [rad]: a robot that is near itself, and a pose that is not reached.
_NEAR, _FAR = 1e3, 1e6


def solve_apart(
    chain: KinematicChain,
    starts: Float[Array, "starts arm"],
    target: Pose,
    lower: Float[Array, " arm"],
    upper: Float[Array, " arm"],
    own: Callable[[Float[Array, " arm"]], Float[Array, ""]],
) -> tuple[IKSolution, Bool[Array, ""]]:
    """As `jaxpaint.kinematics.solve`, and of the solutions in which the robot is clear of itself, if any, the
    nearest to the first start; and whether this one is clear.

    chain: the arm from the map to the tool. own: gap between parts of the robot with the arm's joints so [m].
    """
    tries = jax.vmap(lambda start: solve(chain, start[None], target, lower, upper))(starts)
    gap = jax.vmap(own)(tries.q)
    error = tries.position_error + tries.orientation_error
    cost = jnp.abs(tries.q - starts[0]).max(-1) + jnp.where(gap < OWN_ROOM, _NEAR, 0)
    best = jnp.argmin(jnp.where(tries.converged, cost, _FAR * (1 + jnp.where(jnp.isfinite(error), error, 1))))
    return jax.tree.map(lambda x: x[best], tries), gap[best] >= OWN_ROOM
