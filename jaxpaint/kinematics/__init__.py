"""Where the robot's frames are, how they move, and how to get them somewhere."""

from jaxpaint.kinematics.chain import (
    KinematicChain,
    arm_chain,
    forward,
    frames,
    jacobian,
    tool_jacobian,
    tool_pose,
    with_tool,
)
from jaxpaint.kinematics.dynamics import Inertia, inverse_dynamics
from jaxpaint.kinematics.ik import IKSettings, IKSolution, solve, spread_starts
from jaxpaint.kinematics.manipulability import manipulability, manipulability_gradient
from jaxpaint.kinematics.parts import (
    BodyParts,
    Gap,
    LinkBoxes,
    LinkSpheres,
    no_parts,
    own_gap_slope,
    plane_gap_slope,
)
from jaxpaint.kinematics.pose import Pose, matrix_from_pose, pose_from_matrix
from jaxpaint.kinematics.rotations import (
    compose,
    cross,
    exponential,
    frame_from_axis,
    quaternion_from_rotation,
    rotate,
    rotation_from_quaternion,
    swing_twist,
    transpose,
)
from jaxpaint.kinematics.small_solve import solve_spd
from jaxpaint.kinematics.spheres import Spheres, sphere_centers

__all__ = [
    "BodyParts",
    "Gap",
    "IKSettings",
    "IKSolution",
    "Inertia",
    "KinematicChain",
    "LinkBoxes",
    "LinkSpheres",
    "Pose",
    "Spheres",
    "arm_chain",
    "compose",
    "cross",
    "exponential",
    "forward",
    "frame_from_axis",
    "frames",
    "inverse_dynamics",
    "jacobian",
    "manipulability",
    "manipulability_gradient",
    "matrix_from_pose",
    "no_parts",
    "own_gap_slope",
    "plane_gap_slope",
    "pose_from_matrix",
    "quaternion_from_rotation",
    "rotate",
    "rotation_from_quaternion",
    "solve",
    "solve_spd",
    "sphere_centers",
    "spread_starts",
    "swing_twist",
    "tool_jacobian",
    "tool_pose",
    "transpose",
    "with_tool",
]
