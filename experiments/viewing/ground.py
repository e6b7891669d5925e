"""What the wheels of a run stood on, and how its base leaned there."""

import mujoco
import numpy as np

from experiments.commands.paint_options import PaintOptions
from experiments.paint_fidelity import floor_of
from jaxpaint.errors import InputError
from jaxpaint.mapping.canvas import Canvas
from sims.robots import load_robot

GROUND = "ground/"
TILT = ("tilt/height", "tilt/roll", "tilt/pitch")
"""Joints of the base beyond the robot's own, in the order of `sims.worlds.World.tilt`."""
# From the floor up, each about what those before it have moved; pitch comes before roll.
_JOINTS = (
    (TILT[0], mujoco.mjtJoint.mjJNT_SLIDE, [0.0, 0.0, 1.0]),
    (TILT[2], mujoco.mjtJoint.mjJNT_HINGE, [0.0, 1.0, 0.0]),
    (TILT[1], mujoco.mjtJoint.mjJNT_HINGE, [1.0, 0.0, 0.0]),
)
_BOARDS = (0.62, 0.48, 0.34, 1.0)


def add_floor(spec: mujoco.MjSpec, options: PaintOptions, canvas: Canvas) -> None:
    """The ramp or bump of a run, where it had one; the scene has the level floor already."""
    if options.fidelity != "wheeled" or options.floor == "flat":
        return
    robot = load_robot(options.robot, brush_site=options.brush_site, camera_site=options.camera_site)
    ground = mujoco.MjSpec()
    for name in floor_of(options, robot, canvas).add(ground, 0.0):
        ground.geom(name).rgba = _BOARDS
    ground.delete(ground.geom("floor"))
    spec.attach(ground, prefix=GROUND, frame=spec.worldbody.add_frame())


def let_tilt(spec: mujoco.MjSpec, *, yaw: str) -> None:
    """Gives the base the joints `TILT`, about the point of the floor below the joint `yaw`.

    Raises InputError where there is no such joint.
    """
    joint = spec.joint(yaw)
    if joint is None:
        raise InputError(f"robot: found no joint {yaw!r}, allowed: the robot of the run, unchanged")
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    body = model.joint(yaw).bodyid[0]
    place, R = data.xpos[body], data.xmat[body].reshape(3, 3)
    foot = R.T @ (data.joint(yaw).xanchor * [1, 1, 0] - place)
    for key in list(spec.keys):  # of a model that has fewer joints
        spec.delete(key)
    for name, kind, axis in _JOINTS:
        joint.parent.add_joint(name=name, type=kind, axis=R.T @ np.asarray(axis), pos=foot)
