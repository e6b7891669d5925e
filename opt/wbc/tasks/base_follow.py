"""Base follow: the base is drawn to the velocity that the low-speed rule demands."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from opt.wbc.pieces import Objective
from opt.wbc.settings import ControllerSettings


def base_follow(
    velocity: Float[Array, "3"], ruled: Float[Array, ""], settings: ControllerSettings, arm_joints: int
) -> Objective:
    """k/2 |q_base - d|^2 with the demanded velocity d (x, y, yaw; 0 while the base is halted).

    ruled: 1 where the signed low-speed rule is on; else, as with weight k = `base_follow` 0, it is left out:
    effort and manipulability alone decide how base and arm share the motion.
    """
    weight = jnp.broadcast_to(settings.base_follow * ruled, velocity.shape)
    arm = jnp.zeros_like(velocity, shape=(arm_joints,))
    return Objective(jnp.concatenate([weight, arm]), jnp.concatenate([-weight * velocity, arm]))
