"""Manipulability: the arm keeps away from postures in which it cannot move its brush everywhere."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.kinematics.manipulability import manipulability_gradient
from opt.wbc.pieces import Objective
from opt.wbc.settings import ControllerSettings

# Bounds the gradient where the arm is singular.
_DAMPING = 1e-4


def climb(jacobian: Float[Array, "6 n"], settings: ControllerSettings, base_size: int) -> Objective:
    """-k (dm/dq)' q, the linear term C of S1-(10), with m = sqrt(det(J_a J_a')) of the arm's columns J_a.

    As in S1's reference [26]; weight k = `manipulability`, 0 leaves it out.
    """
    slope = manipulability_gradient(jacobian[:, base_size:], damping=_DAMPING)[1]
    linear = jnp.concatenate([jnp.zeros_like(slope, shape=(base_size,)), -settings.manipulability * slope])
    return Objective(jnp.zeros_like(linear), linear)
