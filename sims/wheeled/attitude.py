"""The base of fidelity `wheeled` as MuJoCo has it, a position and a quaternion, and as a `World` has it."""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.steering.angles import wrap


class Placed(NamedTuple):
    """base: (x, y [m], yaw [rad]). tilt: height [m], roll, pitch [rad]: `sims.worlds.World`."""

    base: Float[Array, "3"]
    tilt: Float[Array, "3"]


def to_free_joint(placed: Placed) -> Float[Array, "7"]:
    """Position and quaternion (w, x, y, z) of Rz(yaw) Ry(pitch) Rx(roll)."""
    base, tilt = placed
    half = jnp.stack([base[2], tilt[2], tilt[1]]) / 2
    (cy, cp, cr), (sy, sp, sr) = jnp.cos(half), jnp.sin(half)
    w, x = cy * cp * cr + sy * sp * sr, cy * cp * sr - sy * sp * cr
    y, z = cy * sp * cr + sy * cp * sr, sy * cp * cr - cy * sp * sr
    return jnp.stack([base[0], base[1], tilt[0], w, x, y, z])


def from_free_joint(q: Float[Array, "7"], yaw: Float[Array, ""]) -> Placed:
    """The inverse; yaw: the last one, from which the new one is no full turn away [rad]."""
    w, x, y, z = q[3], q[4], q[5], q[6]
    heading = jnp.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    roll = jnp.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    pitch = jnp.arcsin(jnp.clip(2 * (w * y - z * x), -1, 1))
    turned = yaw + wrap(heading - yaw)
    return Placed(jnp.stack([q[0], q[1], turned]), jnp.stack([q[2], roll, pitch]))


def integrated(q: Float[Array, "7"], twist: Float[Array, "6"], h: Float[Array, ""]) -> Float[Array, "7"]:
    """The free joint `h` [s] later. twist: linear in the map's axes [m/s], angular in the base's [rad/s]."""
    turn = twist[3:] * h
    square = (turn**2).sum()
    safe = jnp.where(square > 0, square, 1)
    angle = jnp.sqrt(safe)
    scale = jnp.where(square > 0, jnp.sin(angle / 2) / angle, 0.5)
    c = jnp.where(square > 0, jnp.cos(angle / 2), 1)
    x, y, z = turn[0] * scale, turn[1] * scale, turn[2] * scale
    qw, qx, qy, qz = q[3], q[4], q[5], q[6]
    after = jnp.stack(
        [
            qw * c - qx * x - qy * y - qz * z,
            qw * x + qx * c + qy * z - qz * y,
            qw * y - qx * z + qy * c + qz * x,
            qw * z + qx * y - qy * x + qz * c,
        ]
    )
    return jnp.concatenate([q[:3] + twist[:3] * h, after / jnp.sqrt((after**2).sum())])
