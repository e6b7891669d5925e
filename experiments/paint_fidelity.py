"""How truly a painting job's worlds move, by a user's options."""

import math

import numpy as np

from experiments.commands.paint_options import PaintOptions
from jaxpaint.mapping.canvas import Canvas
from sims.painting.survey import axes_of, base_before, camera_arm
from sims.robots import Robot, robot_model
from sims.worlds import Fidelity, Kinematic

# Beside the robot's place before the middle of the canvas: clear of its wheels as it stands there [m].
_ASIDE = 0.5


def fidelity_of(options: PaintOptions, robot: Robot, canvas: Canvas) -> Fidelity:
    """The fidelity of a job, compiled with its programs. Raises InputError."""
    if options.fidelity == "kinematic":
        return Kinematic()
    sites = {"brush_site": options.brush_site, "camera_site": options.camera_site}
    model = robot_model(options.robot, **sites)
    if options.fidelity == "dynamic":
        from sims.dynamics import dynamic  # MJX takes a second to import

        return dynamic(model)
    from sims.wheeled import wheeled

    home = np.asarray(robot.home, float)
    return wheeled(model, home, floor=floor_of(options, robot, canvas), friction=options.friction)


def floor_of(options: PaintOptions, robot: Robot, canvas: Canvas):
    """A bump or a ramp lies across the robot's way along the wall, to the left of the canvas's middle."""
    from sims.wheeled import Bump, Flat, Ramp

    if options.floor == "flat":
        return Flat()
    yaw, (_, left) = float(canvas.yaw), axes_of(canvas)
    x, y = base_before(canvas, camera_arm(robot)) + _ASIDE * left
    if options.floor == "bump":
        return Bump(center=(float(x), float(y)), yaw=yaw)
    return Ramp(start=(float(x), float(y)), yaw=yaw + math.pi / 2)
