"""What a controller knows of the robot."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.kinematics import BodyParts, KinematicChain
from jaxpaint.steering import AbstractDrive


class RobotLimits(eqx.Module):
    """A chain of a base (x, y, yaw; or none: a fixed arm) and an arm, and what both can do.

    home: brush in the base frame at the best posture (x, y) [m]. Base limits are of (x, y, yaw) in the map
    frame [m/s, rad/s, m/s^2, rad/s^2], of length 0 for a fixed arm, whose drive is never asked; arm limits of
    the joints [rad, rad/s, rad/s^2]. parts: what is kept clear of itself and of the wall; how many clearance
    rows the program has depends on it alone (`no_parts`: none).
    """

    chain: KinematicChain
    drive: AbstractDrive
    home: Float[Array, "2"]
    base_speed: Float[Array, "b"]
    base_acceleration: Float[Array, "b"]
    arm_lower: Float[Array, "a"]
    arm_upper: Float[Array, "a"]
    arm_speed: Float[Array, "a"]
    arm_acceleration: Float[Array, "a"]
    parts: BodyParts

    @property
    def base_size(self) -> int:
        """How many of the chain's joints are the base's: 3, or 0 for a fixed arm."""
        return self.chain.size - self.arm_joints

    @property
    def arm_joints(self) -> int:
        """How many are the arm's."""
        return self.arm_lower.shape[0]

    def joints(self, base: Float[Array, "3"], arm: Float[Array, "a"]) -> Float[Array, "n"]:
        """All joints of the chain; a fixed arm's chain knows where it stands."""
        return jnp.concatenate([base[: self.base_size], arm])
