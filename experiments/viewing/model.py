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
# Moments of the run among the model's keyframes.
KEYFRAMES = 20
_SKY, _HORIZON = (0.80, 0.86, 0.92), (0.97, 0.98, 0.99)
# A lamp from behind the robot's left shoulder, whose shadows fall to the right of the brush: so far before the
# canvas, to its left, and above its middle [m]. A spot: shadows of MuJoCo's parallel light speckle the floor.
_LAMP = (2.5, 2.0, 2.9)


def room_model(options: PaintOptions, scene: Scene, canvas: Canvas) -> mujoco.MjSpec:
    """The robot of a painting job with its scene, whose names begin with `wall/`. Raises InputError."""
    spec = robot_spec(options.robot, brush_site=options.brush_site)
    wall = mujoco.MjSpec.from_string(scene_mjcf(scene))
    spec.attach(wall, prefix=WALL, frame=spec.worldbody.add_frame())
    _light(spec, canvas)
    return spec


def look_from(spec: mujoco.MjSpec, view: View) -> None:
    """Makes a view that of MuJoCo's free camera, which every viewer starts with."""
    spec.stat.center, spec.stat.extent = view.lookat, view.distance / 1.5  # as mjv_defaultFreeCamera has it
    visual = spec.visual.global_
    visual.azimuth, visual.elevation = np.degrees([view.azimuth, view.elevation])
    visual.fovy = np.degrees(FIELD)


def add_keyframes(
    spec: mujoco.MjSpec, time: Float[np.ndarray, " t"], qpos: Float[np.ndarray, "t nq"]
) -> None:
    """Evenly spaced moments of the run in place of the robot's own keyframes."""
    for key in list(spec.keys):
        spec.delete(key)
    for row in np.unique(np.linspace(0, len(time) - 1, KEYFRAMES).astype(int)):
        spec.add_key(name=f"at {time[row]:.1f} s", time=time[row], qpos=qpos[row])


def _light(spec: mujoco.MjSpec, canvas: Canvas) -> None:
    """Light from all sides, a lamp with shadows, and a bright sky where the robot brings none."""
    visual = spec.visual
    visual.headlight.ambient, visual.headlight.diffuse = np.full(3, 0.45), np.full(3, 0.3)
    visual.headlight.specular = np.full(3, 0.05)
    axes = np.stack([np.asarray(axis, float) for axis in (-canvas.ray, -canvas.u_axis, canvas.v_axis)])
    spec.worldbody.add_light(
        name=f"{WALL}lamp",
        type=mujoco.mjtLightType.mjLIGHT_SPOT,
        pos=np.asarray(canvas.center, float) + _LAMP @ axes,
        dir=-(_LAMP @ axes) / np.linalg.norm(_LAMP),
        cutoff=70.0,
        exponent=1.0,
        diffuse=np.full(3, 0.5),
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
