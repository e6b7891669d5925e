"""What the programs know of a robot."""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.kinematics import Inertia, KinematicChain, Pose, Spheres, arm_chain, with_tool
from jaxpaint.steering import AbstractDrive


class Robot(eqx.Module):
    """A planar base that carries an arm with a brush and a camera.

    chain: from the map to the brush, joints (base_x, base_y, base_yaw, arm...). The base's frame lies on the
    floor, x forwards. home: the arm's painting posture [rad]. lower, upper: the arm's limits [rad].
    speed_limit, acceleration_limit: of all joints (base first) [m/s, rad/s, and per second]. T_brush_camera:
    axes of both z along the tool, the camera's y down when the brush's is. T_base_lidar. drive: how the base
    rolls. footprint: corners of the base's rectangle in its frame, front left first, counter-clockwise [m].
    spheres: the body without the brush, for clearance; brush: the brush. inertia: of what each joint carries.
    torque_limit: of its motors [N m or N].
    """

    chain: KinematicChain
    home: Float[Array, " arm"]
    lower: Float[Array, " arm"]
    upper: Float[Array, " arm"]
    speed_limit: Float[Array, " joints"]
    acceleration_limit: Float[Array, " joints"]
    T_brush_camera: Pose
    T_base_lidar: Pose
    drive: AbstractDrive
    footprint: Float[Array, "4 2"]
    spheres: Spheres
    brush: Spheres
    inertia: Inertia
    torque_limit: Float[Array, " joints"]

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

    @property
    def body_and_brush(self) -> Spheres:
        """The spheres of both, the body's first."""
        return jax.tree.map(lambda a, b: jnp.concatenate([a, b]), self.spheres, self.brush)

    def at_home(self, q_base: Float[Array, "3"]) -> Float[Array, " joints"]:
        """All joints with the base at (x, y, yaw) and the arm at home."""
        return jnp.concatenate([q_base, self.home])
