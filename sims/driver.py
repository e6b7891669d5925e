"""The base's drives: wheels that take time to turn and to gather speed."""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.steering import AbstractDrive


class Wheels(NamedTuple):
    """angle: of the steering axes [rad], 0 where nothing steers. speed: of the rims [m/s]."""

    angle: Float[Array, "w"]
    speed: Float[Array, "w"]


def drive(
    base: AbstractDrive,
    wheels: Wheels,
    twist: Float[Array, "3"],
    steer_twist: Float[Array, "3"],
    acceleration: float | Float[Array, ""],
    dt: Float[Array, ""],
) -> Wheels:
    """Wheels after one control step.

    What steers turns towards `steer_twist` at its rate limit. The whole twist is scaled down where one wheel
    would be too fast. acceleration: of the rims [m/s^2].
    """
    angle = base.steered(steer_twist, wheels.angle, dt)
    rim = base.rolled(twist, angle)
    rim = rim * jnp.minimum(1.0, base.speed_limit / jnp.maximum(jnp.abs(rim).max(), 1e-6))
    change = acceleration * dt
    return Wheels(angle, wheels.speed + jnp.clip(rim - wheels.speed, -change, change))
