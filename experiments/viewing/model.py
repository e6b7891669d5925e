"""A run's robot before its wall as one MuJoCo specification, made to be looked at."""

import mujoco
import numpy as np
from jaxtyping import Float

from experiments.commands.paint_options import PaintOptions
from experiments.viewing.camera import FIELD, View
from jaxpaint.mapping.canvas import Canvas
from sims.robots.read import robot_spec
from sims.scenes import scene_mjcf
from sims.scenes.scene import Scene

WALL = "wall/"
# A wall within this share of the way from the camera to what it looks at is in the way; group of such walls.
_NEARER, _NOT_SHOWN = 0.5, 5
# Moments of the run among the model's keyframes.
KEYFRAMES = 20
_SKY, _HORIZON = (0.80, 0.86, 0.92), (0.97, 0.98, 0.99)
# A lamp from behind the robot's left shoulder, whose shadows fall to the right of the brush: its direction
# from the canvas (before it, left, up) and how much further than the camera it is. A spot: parallel light
# in MuJoCo, and lamps near by, have shadows that speckle the floor.
_LAMP, _FURTHER = np.array([0.58, 0.46, 0.67]), 1.3


def room_model(options: PaintOptions, scene: Scene) -> mujoco.MjSpec:
    """The robot of a painting job with its scene, whose names begin with `wall/`. Raises InputError."""
    spec = robot_spec(options.robot, brush_site=options.brush_site)
    wall = mujoco.MjSpec.from_string(scene_mjcf(scene))
    spec.attach(wall, prefix=WALL, frame=spec.worldbody.add_frame())
    return spec


def look_from(spec: mujoco.MjSpec, view: View) -> None:
    """Makes a view that of MuJoCo's free camera, which every viewer starts with."""
    spec.stat.center, spec.stat.extent = view.lookat, view.distance / 1.5  # as mjv_defaultFreeCamera has it
    visual = spec.visual.global_
    visual.azimuth, visual.elevation = np.degrees([view.azimuth, view.elevation])
    visual.fovy = np.degrees(FIELD)


def light(spec: mujoco.MjSpec, canvas: Canvas, distance: float) -> None:
    """Light from all sides, a lamp with shadows, and a bright sky where the robot brings none.

    distance: of the camera [m].
    """
    spec.visual.quality.numslices = 128  # a column is drawn as a prism, whose edges would cut through paint
    head = spec.visual.headlight
    head.ambient, head.diffuse, head.specular = np.full(3, 0.5), np.full(3, 0.3), np.full(3, 0.05)
    towards = _LAMP @ np.stack(
        [np.asarray(axis, float) for axis in (-canvas.ray, -canvas.u_axis, canvas.v_axis)]
    )
    spec.worldbody.add_light(
        name=f"{WALL}lamp",
        type=mujoco.mjtLightType.mjLIGHT_SPOT,
        pos=np.asarray(canvas.center, float) + _FURTHER * distance * towards,
        dir=-towards,
        cutoff=70.0,
        exponent=1.0,
        diffuse=np.full(3, 0.45),
        specular=np.full(3, 0.1),
        castshadow=True,
    )
    if any(texture.type == mujoco.mjtTexture.mjTEXTURE_SKYBOX for texture in spec.textures):
        return
    spec.add_texture(
        name=f"{WALL}sky",
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
        rgb1=_SKY,
        rgb2=_HORIZON,
        width=256,
        height=1536,
    )


def hide_what_blocks(
    spec: mujoco.MjSpec, model: mujoco.MjModel, view: View, points: Float[np.ndarray, "n 3"]
) -> None:
    """Puts walls that stand between the camera and the points, nearer to the camera, into a group that is not
    shown: a camera behind a room's wall sees into the room.
    """
    data, geom = mujoco.MjData(model), np.zeros(1, np.int32)
    mujoco.mj_forward(model, data)
    for point in points:
        way = point - view.position
        before = mujoco.mj_ray(model, data, view.position, way, None, 1, -1, geom, None)
        name = model.geom(geom[0]).name if 0 <= before < _NEARER else ""
        if name.startswith(WALL):
            spec.geom(name).group = _NOT_SHOWN


def add_keyframes(
    spec: mujoco.MjSpec, time: Float[np.ndarray, " t"], qpos: Float[np.ndarray, "t nq"]
) -> None:
    """Evenly spaced moments of the run in place of the robot's own keyframes."""
    for key in list(spec.keys):
        spec.delete(key)
    for row in np.unique(np.linspace(0, len(time) - 1, KEYFRAMES).astype(int)):
        spec.add_key(name=f"at {time[row]:.1f} s", time=time[row], qpos=qpos[row])
