"""What the programs know of a robot."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.kinematics import KinematicChain, Pose, Spheres, arm_chain, with_tool


class Wheels(eqx.Module):
    """Four steered wheels, front left, front right, rear left, rear right.

    position: steering axes (a_i, b_i) in the base frame [m], offset l = 0. radius [m]. steer_speed,
    drive_speed: limits of the steering and of the driving joints [rad/s].
    """

    position: Float[Array, "4 2"]
    radius: Float[Array, ""]
    steer_speed: Float[Array, ""]
    drive_speed: Float[Array, ""]


class Robot(eqx.Module):
    """A planar base that carries an arm with a brush and a camera.

    chain: from the map to the brush, joints (base_x, base_y, base_yaw, arm...). The base's frame lies on the
    floor, x forwards. home: the arm's painting posture [rad]. lower, upper: the arm's limits [rad].
    speed_limit, acceleration_limit: of all joints (base first) [m/s, rad/s, and per second]. T_brush_camera:
    axes of both z along the tool, the camera's y down when the brush's is. T_base_lidar. footprint: corners
    of the base's rectangle in its frame, front left first, counter-clockwise [m]. spheres: the body without
    the brush, for clearance.
    """

    chain: KinematicChain
    home: Float[Array, " arm"]
    lower: Float[Array, " arm"]
    upper: Float[Array, " arm"]
    speed_limit: Float[Array, " joints"]
    acceleration_limit: Float[Array, " joints"]
    T_brush_camera: Pose
    T_base_lidar: Pose
    wheels: Wheels
    footprint: Float[Array, "4 2"]
    spheres: Spheres

    @property
    def base_size(self) -> int:
        """How many of the chain's joints are the base's."""
        return self.chain.size - self.home.shape[0]

    def arm(self, q_base: Float[Array, "3"]) -> KinematicChain:
        """The arm to the brush, seen from the map, with the base at (x, y, yaw) [m, rad]."""
        return arm_chain(self.chain, q_base)

    @property
    def camera_chain(self) -> KinematicChain:
        """The same joints, to the camera."""
        return with_tool(self.chain, self.T_brush_camera)

    def at_home(self, q_base: Float[Array, "3"]) -> Float[Array, " joints"]:
        """All joints with the base at (x, y, yaw) and the arm at home."""
        return jnp.concatenate([q_base, self.home])
