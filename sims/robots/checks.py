"""Whether a robot that was read can paint a wall at all."""

import jax.numpy as jnp
import numpy as np

from jaxpaint.errors import InputError
from jaxpaint.kinematics import forward, sphere_centers
from sims.robots.robot import Robot

# A brush and an upright camera have six degrees of freedom.
_LEAST_JOINTS = 6
# The body ends this far behind the plane of the brush's tip at home [m].
_BEHIND = 0.005
# The brush's axis at home leans less than this from level and from straight ahead [rad].
_LEAN = np.radians(30)


def check_goes_sideways(robot: Robot) -> None:
    """Raises InputError for a base that cannot follow every path in the plane, as a differential base."""
    if robot.drive.nonholonomic_rows.shape[0]:
        raise InputError(
            "a differential base cannot go along its axle, as the paths planned for bases do; "
            "allowed: steered wheels, casters, mecanum wheels, or no wheel joints (holonomic)"
        )


def check_can_paint(robot: Robot) -> None:
    """Raises InputError for a differential base, an arm with too few joints, or a home from which no wall is
    painted.
    """
    check_goes_sideways(robot)
    joints = robot.home.shape[0]
    if joints < _LEAST_JOINTS:
        raise InputError(
            f"the arm has {joints} joints; allowed: {_LEAST_JOINTS} or more, as a camera that looks at a "
            "wall upright needs"
        )
    lower, upper = np.asarray(robot.lower), np.asarray(robot.upper)
    home = np.asarray(robot.home)
    for k in np.flatnonzero(~((home >= lower - 1e-6) & (home <= upper + 1e-6))):
        name = robot.chain.names[robot.base_size + k]
        raise InputError(
            f"keyframe 'home' has {home[k]:g} for '{name}'; allowed: {lower[k]:g} to {upper[k]:g}"
        )
    q = robot.at_home(jnp.zeros(3))
    brush = forward(robot.chain, q)
    axis, place = np.asarray(brush.R[:, 2]), np.asarray(brush.p)
    front = float(robot.footprint[:, 0].max())
    if not (axis[0] >= np.cos(_LEAN) and place[0] >= front):
        raise InputError(
            f"at home the brush is at {place.round(2).tolist()} m and points along {axis.round(2).tolist()} "
            f"in the base frame; allowed: ahead of the base (x above {front:.2f} m), along +x within "
            f"{np.degrees(_LEAN):g} degrees; site 'brush' has its z axis out of the tool"
        )
    centers = np.asarray(sphere_centers(robot.chain, robot.spheres, q))
    gap = -((centers - place) @ axis + np.asarray(robot.spheres.radius))
    if len(gap) and not gap.min() >= _BEHIND:
        name = robot.chain.names[int(robot.spheres.frame[int(gap.argmin())])]
        raise InputError(
            f"at home the body behind joint '{name}' reaches to {gap.min():.3f} m behind the brush's tip; "
            f"allowed: {_BEHIND} m or more; the name of what touches the wall, "
            "a geom or its body, begins with 'brush'"
        )
