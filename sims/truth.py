"""Where brush, camera and lidar truly are, which the robot only believes to know."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.kinematics import Pose, frames, tool_pose, with_tool
from jaxpaint.kinematics.chain import KinematicChain
from jaxpaint.kinematics.rotations import compose, exponential, rotate
from sims.parameters import scalar
from sims.robots import Robot


class Calibration(eqx.Module):
    """What the robot's picture of itself is wrong by. joints: by how much the true angles of the arm are more
    than its encoders' [rad], one for all or one each. camera_position [m], camera_rotation (rotation vector)
    [rad]: the true camera seen from where it is taken to be.
    """

    joints: Float[Array, "*a"] = eqx.field(converter=scalar, default=0.0)
    camera_position: Float[Array, "*xyz"] = eqx.field(converter=scalar, default=0.0)
    camera_rotation: Float[Array, "*xyz"] = eqx.field(converter=scalar, default=0.0)


def true_brush(
    chain: KinematicChain,
    wrong: Calibration,
    base: Float[Array, "3"],
    tilt: Float[Array, "3"],
    arm: Float[Array, " a"],
) -> Pose:
    """T_map_brush of a base at (x, y, yaw), tilted (`World.tilt`), and an arm with these encoder readings."""
    links = frames(chain, jnp.concatenate([base, arm + wrong.joints]))
    # The yaw's axis, on the floor: about there a base tilts.
    foot = links.p[base.shape[0] - 1] * jnp.asarray([1, 1, 0], arm.dtype)
    return tilted(tool_pose(chain, links), foot, base[2], tilt)


def true_camera(
    robot: Robot,
    wrong: Calibration,
    base: Float[Array, "3"],
    tilt: Float[Array, "3"],
    arm: Float[Array, " a"],
) -> Pose:
    """T_map_camera, likewise."""
    zero = jnp.zeros(3, arm.dtype)
    moved = Pose(wrong.camera_position + zero, exponential(wrong.camera_rotation + zero))
    chain = with_tool(robot.camera_chain, moved)
    return true_brush(chain, wrong, base, tilt, arm)


def true_lidar(robot: Robot, base: Float[Array, "3"], tilt: Float[Array, "3"]) -> Pose:
    """T_map_lidar, likewise."""
    zero, one = jnp.zeros_like(base[2]), jnp.ones_like(base[2])
    up = jnp.stack([zero, zero, one])
    standing = Pose(jnp.stack([base[0], base[1], zero]), exponential(base[2] * up))
    return tilted(standing @ robot.T_base_lidar, standing.p, base[2], tilt)


def tilted(pose: Pose, foot: Float[Array, "3"], yaw: Float[Array, ""], tilt: Float[Array, "3"]) -> Pose:
    """A pose on a level base, after the base was lifted and tilted about its foot. tilt: `World.tilt`."""
    R = tilt_rotation(yaw, tilt)
    lift = jnp.stack([jnp.zeros_like(yaw), jnp.zeros_like(yaw), tilt[0]])
    return Pose(foot + rotate(R, pose.p - foot) + lift, compose(R, pose.R))


def tilt_rotation(yaw: Float[Array, ""], tilt: Float[Array, "3"]) -> Float[Array, "3 3"]:
    """R with R Rz(yaw) = Rz(yaw) Ry(pitch) Rx(roll), in the map frame."""
    (sy, cy), (sr, cr), (sp, cp) = ((jnp.sin(a), jnp.cos(a)) for a in (yaw, tilt[1], tilt[2]))
    zero, one = jnp.zeros_like(yaw), jnp.ones_like(yaw)
    turn = jnp.stack([jnp.stack([cy, -sy, zero]), jnp.stack([sy, cy, zero]), jnp.stack([zero, zero, one])])
    pitch_roll = jnp.stack(
        [
            jnp.stack([cp, sp * sr, sp * cr]),
            jnp.stack([zero, cr, -sr]),
            jnp.stack([-sp, cp * sr, cp * cr]),
        ]
    )
    return compose(compose(turn, pitch_roll), turn.T)
