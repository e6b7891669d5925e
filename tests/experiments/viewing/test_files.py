"""The model and the motion that are written are those of the run, and need nothing else."""

import dataclasses
from pathlib import Path
from shutil import move

import mujoco
import numpy as np
import pytest
from PIL import Image

from experiments.viewing import read_recorded, write_view
from experiments.viewing.ground import TILT
from experiments.viewing.model import KEYFRAMES
from jaxpaint.errors import InputError
from sims.robots import load_robot, robot_model
from sims.robots.read import REFERENCE
from sims.truth import Calibration, true_brush

URDF = Path(__file__).resolve().parents[2] / "robots" / "big_arm.urdf"
TETRAHEDRON = "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"


def test_the_model_is_the_robot_before_its_wall(view):
    model = mujoco.MjModel.from_xml_path(str(view / "model.xml"))
    assert model.nq == robot_model().nq + len(TILT)
    assert model.geom("wall/scene_0").type == mujoco.mjtGeom.mjGEOM_BOX
    assert model.nkey == KEYFRAMES
    with np.load(view / "trajectory.npz") as run:
        assert run["joint_names"].tolist() == [model.joint(k).name for k in range(model.njnt)]
        assert run["qpos"].shape == (60, model.nq)
        np.testing.assert_allclose(model.key_time[[0, -1]], run["time"][[0, -1]])
        np.testing.assert_allclose(model.key_qpos[-1], run["qpos"][-1], atol=1e-4)
        assert np.ptp(run["qpos"][:, model.joint("wheel_fl").qposadr[0]]) > 1, "wheels roll"


def test_the_camera_sees_brush_and_canvas(view):
    model = mujoco.MjModel.from_xml_path(str(view / "model.xml"))
    camera = mujoco.MjvCamera()
    mujoco.mjv_defaultFreeCamera(model, camera)
    assert camera.distance < 8
    assert -45 < camera.azimuth < 45
    assert -45 < camera.elevation < -10


def test_a_robot_that_is_another_now_is_refused(recorded_run, tmp_path):
    recorded = read_recorded(recorded_run, "RUN")
    motion = dataclasses.replace(recorded.motion(3), names=(*recorded.motion(3).names[:-1], "wrist_4"))
    with pytest.raises(InputError, match="no joint 'wrist_4'"):
        write_view(recorded, motion, tmp_path, 1.0)


@pytest.mark.parametrize("floor", ["ramp", "bump"])
def test_a_base_leans_on_what_it_stands_on(recorded_run, tmp_path, floor):
    """The brush of the model is where simulation has it."""
    recorded = read_recorded(recorded_run, "RUN")
    options = dataclasses.replace(recorded.options, fidelity="wheeled", floor=floor)
    tilt = np.random.default_rng(0).normal(size=(60, 3)) * [0.01, 0.1, 0.1]
    motion = dataclasses.replace(recorded.motion(3), tilt=tilt)
    write_view(dataclasses.replace(recorded, options=options), motion, tmp_path, 1.0)
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "model.xml"))
    data = mujoco.MjData(model)
    chain = load_robot().chain
    with np.load(tmp_path / "trajectory.npz") as run:
        for row in (0, 30, 59):
            data.qpos[:] = run["qpos"][row]
            mujoco.mj_kinematics(model, data)
            joints, lean = motion.joints[row].astype(np.float32), tilt[row].astype(np.float32)
            brush = true_brush(chain, Calibration(), joints[:3], lean, joints[3:])
            np.testing.assert_allclose(data.site("brush").xpos, brush.p, atol=1e-5)
    assert model.geom(f"ground/{floor}").pos[1] == pytest.approx(0.5, abs=0.02), "left of the middle"


@pytest.mark.parametrize("wall", ["corner", "cylinder", "objects", "room"])
def test_every_wall(recorded_run, tmp_path, wall):
    recorded = read_recorded(recorded_run, "RUN")
    options = dataclasses.replace(recorded.options, wall=wall)
    write_view(dataclasses.replace(recorded, options=options), recorded.motion(3), tmp_path, 1.0)
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "model.xml"))
    assert model.geom("wall/scene_0").group == 0, "what is painted is shown"


def test_meshes_and_textures_come_along(recorded_run, tmp_path):
    """The robot's files may go away afterwards."""
    parts, out = tmp_path / "robot" / "parts", tmp_path / "view"
    parts.mkdir(parents=True)
    out.mkdir()
    (parts / "hat.obj").write_text(TETRAHEDRON)
    Image.new("RGB", (8, 8)).save(parts / "felt.png")
    text = REFERENCE.read_text()
    text = text.replace("<compiler ", '<compiler meshdir="parts" texturedir="parts" ')
    text = text.replace(
        "<asset>", '<asset><mesh file="hat.obj"/><texture name="felt" type="2d" file="felt.png"/>'
    )
    text = text.replace('<geom name="chassis"', '<geom type="mesh" mesh="hat"/><geom name="chassis"')
    (tmp_path / "robot" / "robot.xml").write_text(text)
    recorded = read_recorded(recorded_run, "RUN")
    options = dataclasses.replace(recorded.options, robot=tmp_path / "robot" / "robot.xml")
    write_view(dataclasses.replace(recorded, options=options), recorded.motion(3), out, 1.0)
    move(tmp_path / "robot", tmp_path / "gone")
    model = mujoco.MjModel.from_xml_path(str(out / "model.xml"))
    assert str(tmp_path) not in (out / "model.xml").read_text()
    assert model.nmesh == 1
    assert model.mesh_vertnum[0] == 4
    assert sorted(path.name for path in out.iterdir()) == [
        "mesh_0.obj", "model.xml", "play.py", "texture_0.png", "trajectory.npz",
    ]  # fmt: skip


def test_a_urdf_with_a_link_for_its_brush(recorded_run, tmp_path):
    recorded = read_recorded(recorded_run, "RUN")
    options = dataclasses.replace(recorded.options, robot=URDF, brush_site="tool0")
    motion = recorded.motion(3)
    arm = ("shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint")
    motion = dataclasses.replace(motion, names=(*motion.names[:3], *arm), joints=motion.joints[:, :6])
    write_view(dataclasses.replace(recorded, options=options), motion, tmp_path, 1.0)
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "model.xml"))
    assert model.site("brush").id >= 0
