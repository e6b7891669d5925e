"""Effort: what moving costs."""

import jax.numpy as jnp

from opt.wbc.pieces import Objective
from opt.wbc.settings import ControllerSettings


def effort(settings: ControllerSettings, base_size: int) -> Objective:
    """1/2 q'Mq, the quadratic term of S1-(10): M = diag(base_effort, arm_effort).

    The base's motion is dearer than the arm's, as in S1's reference [26]. A joint whose effort is 0 moves at
    no cost.
    """
    weight = jnp.concatenate([settings.base_effort[:base_size], settings.arm_effort])
    return Objective(weight, jnp.zeros_like(weight))
