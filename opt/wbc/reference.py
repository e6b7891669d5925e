"""Where the brush should be, and how it should move there."""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from opt.plan import Samples


class Reference(NamedTuple):
    """Where the brush should be now, in the map frame, and how it moves there.

    position [m], rotation (columns are the brush's axes), velocity [m/s], angular_velocity [rad/s], pen (1
    down).
    """

    position: Float[Array, "3"]
    rotation: Float[Array, "3 3"]
    velocity: Float[Array, "3"]
    angular_velocity: Float[Array, "3"]
    pen: Float[Array, ""]

    def at_rate(self, rate: Float[Array, ""]) -> "Reference":
        """The same where the plan's clock goes on at `rate`: 1 in time, 0 waits."""
        return self._replace(velocity=self.velocity * rate, angular_velocity=self.angular_velocity * rate)


def read_reference(samples: Samples, clock: Float[Array, ""]) -> Reference:
    """The reference at plan time `clock` [s]."""
    row = samples.at(clock)
    return Reference(row[:3], row[3:12].reshape(3, 3), row[12:15], row[15:18], row[18])


def orientation_error(rotation: Float[Array, "3 3"], wanted: Float[Array, "3 3"]) -> Float[Array, "3"]:
    """Rotation vector, to first order, that turns `rotation` into `wanted` [rad, map frame]."""
    return jnp.cross(rotation, wanted, axisa=0, axisb=0).sum(0) / 2
