"""Random rotations, from uniform draws."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.kinematics.rotations import cross, rotation_from_quaternion


def any_turn(draws: Float[Array, "3"]) -> Float[Array, "3 3"]:
    """A rotation evenly over all there are, from three draws in 0..1 (Shoemake 1992)."""
    inner, outer = jnp.sqrt(1 - draws[0]), jnp.sqrt(draws[0])
    first, second = 2 * jnp.pi * draws[1], 2 * jnp.pi * draws[2]
    return rotation_from_quaternion(
        jnp.stack(
            [
                inner * jnp.sin(first),
                inner * jnp.cos(first),
                outer * jnp.sin(second),
                outer * jnp.cos(second),
            ]
        )
    )


def upright_frame(yaw: Float[Array, ""]) -> Float[Array, "3 3"]:
    """A frame whose y axis is the map's z axis, and whose z axis is level and heads along yaw [rad]."""
    cos, sin, zero = jnp.cos(yaw), jnp.sin(yaw), jnp.zeros_like(yaw)
    return jnp.stack([-sin, zero, cos, cos, zero, sin, zero, zero + 1, zero]).reshape(3, 3)


def turn_about_z(angle: Float[Array, ""]) -> Float[Array, "3 3"]:
    """The rotation about the z axis [rad]."""
    cos, sin, zero = jnp.cos(angle), jnp.sin(angle), jnp.zeros_like(angle)
    return jnp.stack([cos, -sin, zero, sin, cos, zero, zero, zero, zero + 1]).reshape(3, 3)


def frame_about(z: Float[Array, "3"], roll: Float[Array, ""]) -> Float[Array, "3 3"]:
    """A right-handed frame with this z axis, turned about it [rad]."""
    # The map axis that is least along z makes a plane with it that is never degenerate.
    least = (jnp.arange(3) == jnp.argmin(jnp.abs(z))).astype(z.dtype)
    x = cross(least, z)
    x = x / jnp.sqrt((x * x).sum())
    y = cross(z, x)
    cos, sin = jnp.cos(roll), jnp.sin(roll)
    return jnp.stack([cos * x + sin * y, cos * y - sin * x, z], axis=1)
