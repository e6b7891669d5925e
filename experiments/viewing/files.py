"""The files of a view: model.xml with what it needs, trajectory.npz, play.py."""

from collections.abc import Iterator
from itertools import product
from pathlib import Path
from shutil import copyfile

import mujoco
import numpy as np
from jaxtyping import Float

from experiments.placing import placed
from experiments.viewing.camera import view_of
from experiments.viewing.ground import TILT, add_floor, let_tilt
from experiments.viewing.model import add_keyframes, hide_what_blocks, light, look_from, room_model
from experiments.viewing.recorded import Motion, Recorded
from experiments.viewing.wheels import wheel_angles
from jaxpaint.errors import InputError
from jaxpaint.mapping.canvas import Canvas

MODEL, TRAJECTORY, SCRIPT = "model.xml", "trajectory.npz", "play.py"
# Poses that the camera is to show, and points of them to which it needs a clear sight.
_POSES, _LOOKS = 20, 200


def write_view(recorded: Recorded, motion: Motion, folder: Path, aspect: float) -> None:
    """Writes the robot before its wall, the motion and the script that plays it. Raises InputError.

    aspect: width over height of the pictures that are to show all of it.
    """
    place = placed(recorded.options)
    spec = room_model(recorded.options, place.scene)
    add_floor(spec, recorded.options, place.canvas)
    let_tilt(spec, yaw=motion.names[2])
    model = spec.compile()
    qpos = positions(model, motion)
    points = np.concatenate([_canvas_corners(place.canvas), _robot_points(model, qpos)])
    view = view_of(points, float(place.canvas.yaw), aspect)
    look_from(spec, view)
    light(spec, place.canvas, view.distance)
    hide_what_blocks(spec, model, view, points[:: len(points) // _LOOKS + 1])
    add_keyframes(spec, motion.time, qpos)
    _take_along(spec, folder)
    (folder / MODEL).write_text(spec.to_xml(), encoding="utf-8")
    written = mujoco.MjModel.from_xml_path(str(folder / MODEL))
    arrays = {name: getattr(motion, name) for name in ("time", "brush", "stroke", "colour", "palette")}
    np.savez_compressed(
        folder / TRAJECTORY,
        qpos=qpos,
        joint_names=np.array([written.joint(k).name for k in range(written.njnt)]),
        brush_radius=recorded.options.brush_radius,
        **arrays,
    )
    copyfile(Path(__file__).with_name(SCRIPT), folder / SCRIPT)


def positions(model: mujoco.MjModel, motion: Motion) -> Float[np.ndarray, "t nq"]:
    """The model's qpos at every sample; joints that nobody recorded stay where the model has them."""
    qpos = np.tile(model.qpos0, (len(motion.time), 1))
    turned = wheel_angles(model, motion.time, motion.joints[:, :3])
    tilted = zip(TILT, motion.tilt.T, strict=True)
    moved = zip(motion.names, motion.joints.T, strict=True)
    for name, column in {**turned, **dict(tilted), **dict(moved)}.items():
        if mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, name) < 0:
            raise InputError(f"robot: found no joint {name!r}, allowed: the robot of the run, unchanged")
        qpos[:, model.joint(name).qposadr[0]] = column
    return qpos


def _canvas_corners(canvas: Canvas) -> Float[np.ndarray, "4 3"]:
    half = 0.5 * np.asarray(canvas.size, float)
    middle, u, v = (np.asarray(axis, float) for axis in (canvas.center, canvas.u_axis, canvas.v_axis))
    return np.stack([middle + a * half[0] * u + b * half[1] * v for a in (-1, 1) for b in (-1, 1)])


def _robot_points(model: mujoco.MjModel, qpos: Float[np.ndarray, "t nq"]) -> Float[np.ndarray, "n 3"]:
    """Corners of the boxes about the robot's geoms in poses of the whole run [m]."""
    data, mine, found = mujoco.MjData(model), model.geom_bodyid > 0, []
    signs = np.array(list(product((-1, 1), repeat=3)))
    corners = model.geom_aabb[mine, None, :3] + signs * model.geom_aabb[mine, None, 3:]
    for row in np.linspace(0, len(qpos) - 1, _POSES).astype(int):
        data.qpos[:] = qpos[row]
        mujoco.mj_kinematics(model, data)
        turn = data.geom_xmat[mine].reshape(-1, 3, 3)
        found.append(np.einsum("gij,gcj->gci", turn, corners) + data.geom_xpos[mine, None])
    return np.concatenate(found).reshape(-1, 3)


def _take_along(spec: mujoco.MjSpec, folder: Path) -> None:
    """Copies the files of meshes, textures and height fields beside the model, which then asks for those."""
    above = Path(spec.modelfiledir)
    homes = {"mesh": above / spec.meshdir, "hfield": above / spec.meshdir, "texture": above / spec.texturedir}
    for kind, number, asset in _assets(spec):
        source = homes[kind] / asset.file
        asset.file = f"{kind}_{number}{source.suffix.lower()}"
        copyfile(source, folder / asset.file)
    spec.meshdir = spec.texturedir = ""
    spec.modelfiledir = str(folder)  # where it is compiled anew before it is written


def _assets(spec: mujoco.MjSpec) -> Iterator[tuple]:
    """Kind, number and the asset itself, of those that have a file."""
    for kind, assets in (("mesh", spec.meshes), ("hfield", spec.hfields), ("texture", spec.textures)):
        for number, asset in enumerate(assets):
            if asset.file:
                yield kind, number, asset
