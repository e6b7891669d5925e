"""Postures for a pose of the tool in which a robot does not touch itself."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.kinematics import IKSolution, KinematicChain, Pose
from jaxpaint.planning import postures
from jaxpaint.trajectories import own_gap_at
from sims.robots import Robot


def solve_apart(
    robot: Robot,
    chain: KinematicChain,
    base: Float[Array, "3"],
    starts: Float[Array, "starts arm"],
    target: Pose,
) -> IKSolution:
    """`jaxpaint.planning.postures.solve_apart` for a robot, its brush included.

    chain: the arm from the map to the tool, with the base at (x, y, yaw) [m, rad].
    """
    whole = robot.body_and_brush

    def own(q):
        return own_gap_at(robot.chain, whole, robot.at_home(base), jnp.concatenate([base, q]))

    return postures.solve_apart(chain, starts, target, robot.lower, robot.upper, own)[0]
