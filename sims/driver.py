"""The base's drives: four steered wheels that take time to turn and to gather speed."""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.kinematics.steering import SteeringGeometry, contact_velocity, wheel_commands


class Wheels(NamedTuple):
    """angle: of the steering axes [rad]. speed: of the rims [m/s]."""

    angle: Float[Array, "w"]
    speed: Float[Array, "w"]


def drive(
    geometry: SteeringGeometry,
    wheels: Wheels,
    twist: Float[Array, "3"],
    steer_twist: Float[Array, "3"],
    acceleration: float | Float[Array, ""],
    dt: Float[Array, ""],
) -> Wheels:
    """Wheels after one control step.

    The modules turn towards `steer_twist` at their rate limit. Each wheel rolls at the part of its contact
    velocity that lies along its present direction, so a module that is not there yet does not push sideways;
    the whole twist is scaled down where one wheel would be too fast. acceleration: of the rims [m/s^2].
    """
    target, _ = wheel_commands(geometry, steer_twist, wheels.angle)
    step = geometry.rate_limit * dt
    angle = wheels.angle + jnp.clip(target - wheels.angle, -step, step)
    velocity = contact_velocity(geometry, twist)
    rim = velocity[:, 0] * jnp.cos(angle) + velocity[:, 1] * jnp.sin(angle)
    rim = rim * jnp.minimum(1.0, geometry.speed_limit / jnp.maximum(jnp.abs(rim).max(), 1e-6))
    change = acceleration * dt
    return Wheels(angle, wheels.speed + jnp.clip(rim - wheels.speed, -change, change))
