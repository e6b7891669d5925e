"""The base's drives: wheels that take time to turn and to gather speed."""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.steering import AbstractDrive, Stance, WheelMotion


class Wheels(NamedTuple):
    """angle: of the steering axes [rad], 0 where nothing steers. speed: of the rims [m/s]. way: see
    `jaxpaint.steering.Stance`; without it, wheels would tremble where a quarter turn is asked of them.
    """

    angle: Float[Array, "w"]
    speed: Float[Array, "w"]
    way: Float[Array, "w"]


def at_rest(angle: Float[Array, "w"]) -> Wheels:
    """Wheels that stand at these angles and have not gone either way."""
    still = jnp.zeros_like(angle)
    return Wheels(angle, still, still)


def drive(
    base: AbstractDrive,
    wheels: Wheels,
    twist: Float[Array, "3"],
    steer_twist: Float[Array, "3"],
    acceleration: float | Float[Array, ""],
    dt: Float[Array, ""],
) -> tuple[Wheels, WheelMotion]:
    """Wheels after one control step, and what their encoders read in it.

    A step within the limits (`AbstractDrive.step`), of which rims make what their acceleration [m/s^2] lets
    them: until they are there, wheels may disagree.
    """
    stance, motion, _ = base.step(twist, steer_twist, Stance(wheels.angle, wheels.way), dt)
    change = acceleration * dt
    speed = wheels.speed + jnp.clip(motion.speed - wheels.speed, -change, change)
    return Wheels(stance.angle, speed, stance.way), motion._replace(speed=speed)
