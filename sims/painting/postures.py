"""Postures for a pose of the tool in which the robot does not touch itself."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.kinematics import IKSolution, KinematicChain, Pose, Spheres, solve
from jaxpaint.trajectories import own_gap_at
from sims.robots import Robot

# Spheres are fatter than the robot: one whose gap is as large as this is clear, and can be left again [m].
_OWN_ROOM = 0.02
# What is worse than any way of the joints [rad]: a robot that is near itself, and a pose that is not reached.
_NEAR, _FAR = 1e3, 1e6


def solve_apart(
    robot: Robot,
    chain: KinematicChain,
    base: Float[Array, "3"],
    starts: Float[Array, "starts arm"],
    target: Pose,
) -> IKSolution:
    """As `jaxpaint.kinematics.solve`, and of the solutions in which the robot is clear of itself, if any, the
    nearest to the first start.

    chain: the arm from the map to the tool, with the base at (x, y, yaw) [m, rad].
    """

    def one(start):
        return solve(chain, start[None], target, robot.lower, robot.upper)

    tries = jax.vmap(one)(starts)
    whole = jax.tree.map(lambda a, b: jnp.concatenate([a, b]), robot.spheres, robot.brush)
    gap = jax.vmap(lambda q: _gap(robot, whole, base, q))(tries.q)
    error = tries.position_error + tries.orientation_error
    cost = jnp.abs(tries.q - starts[0]).max(-1) + jnp.where(gap < _OWN_ROOM, _NEAR, 0)
    best = jnp.argmin(jnp.where(tries.converged, cost, _FAR * (1 + jnp.where(jnp.isfinite(error), error, 1))))
    return jax.tree.map(lambda x: x[best], tries)


def _gap(robot: Robot, whole: Spheres, base: Float[Array, "3"], q: Float[Array, " arm"]) -> Float[Array, ""]:
    return own_gap_at(robot.chain, whole, robot.at_home(base), jnp.concatenate([base, q]))
