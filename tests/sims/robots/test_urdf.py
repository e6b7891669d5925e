"""URDF files: what is added to them, and what is refused."""

import mujoco
import numpy as np
import pytest
import trimesh

from jaxpaint.errors import InputError
from sims.robots import load_robot, robot_model

HOME_AT_ONCE = "sims.robots.load.painting_posture"


@pytest.fixture
def quick(monkeypatch):
    """Without the search for a posture, which compiles."""
    monkeypatch.setattr(HOME_AT_ONCE, lambda chain, spheres, lower, upper, front: np.zeros(len(lower)))


def written(tmp_path, text):
    path = tmp_path / "own.urdf"
    path.write_text(text)
    return path


def test_limits_of_the_file(quick, tmp_path, urdf_text):
    robot = load_robot(written(tmp_path, urdf_text))
    np.testing.assert_allclose(robot.speed_limit[3:], [2.0944] * 2 + [3.1416] * 4, rtol=1e-5)
    np.testing.assert_allclose(robot.torque_limit[3:], [330, 330, 150, 56, 56, 56])
    assert float(robot.upper[5]) > 6 * np.pi  # continuous
    np.testing.assert_allclose(robot.upper[2], np.pi, rtol=1e-6)
    # above the floor, onto which the root link was lifted by 0.09 m
    np.testing.assert_allclose(robot.T_base_lidar.p, [0.315, 0, 0.45], atol=1e-6)


def test_the_base_is_added_and_stands_on_the_floor(tmp_path, urdf_text):
    model = robot_model(written(tmp_path, urdf_text))
    assert [model.joint(k).name for k in range(3)] == ["base_x", "base_y", "base_yaw"]
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert model.body("base_link").pos[2] == pytest.approx(0.09)  # its box begins 0.09 m below its origin
    np.testing.assert_allclose(data.site("lidar").xpos, [0.315, 0, 0.45], atol=1e-9)


def test_its_servos_hold_it_against_gravity_and_follow(tmp_path, urdf_text):
    model = robot_model(written(tmp_path, urdf_text))
    model.opt.integrator, model.opt.timestep = mujoco.mjtIntegrator.mjINT_IMPLICITFAST, 0.02
    assert not model.geom_contype.any()
    data = mujoco.MjData(model)
    data.joint("shoulder_lift_joint").qpos = -0.8
    data.actuator("shoulder_pan_joint").ctrl = 0.1
    for _ in range(100):
        mujoco.mj_step(model, data)
    names = [model.actuator(k).name for k in range(model.nu)]
    np.testing.assert_allclose(
        [data.joint(n).qvel[0] for n in names], [0.1 * (n == "shoulder_pan_joint") for n in names], atol=2e-3
    )


def test_planar_joints_and_those_by_name_are_taken(tmp_path, urdf_text):
    world = (
        '<link name="world"/><joint name="go" type="planar"><parent link="world"/>'
        '<child link="base_link"/></joint>'
    )
    model = robot_model(written(tmp_path, urdf_text.replace("</robot>", world + "</robot>")))
    assert [model.joint(k).name for k in range(4)] == ["base_x", "base_y", "base_yaw", "shoulder_pan_joint"]
    dummies, parent = "", "odom"
    for name, kind, axis in (
        ("base_x", "prismatic", "1 0 0"),
        ("base_y", "prismatic", "0 1 0"),
        ("base_yaw", "revolute", "0 0 1"),
    ):
        child = "base_link" if name == "base_yaw" else f"after_{name}"
        dummies += (
            f'<link name="{parent}"/><joint name="{name}" type="{kind}"><parent link="{parent}"/>'
            f'<child link="{child}"/><axis xyz="{axis}"/>'
            '<limit lower="-9" upper="9" effort="1000" velocity="0.4"/></joint>'
        )
        parent = child
    path = written(tmp_path, urdf_text.replace("</robot>", dummies + "</robot>"))
    model = robot_model(path)
    assert [model.joint(k).name for k in range(4)] == ["base_x", "base_y", "base_yaw", "shoulder_pan_joint"]


def test_other_names_for_brush_and_camera(quick, tmp_path, urdf_text):
    plain = load_robot(written(tmp_path, urdf_text))
    other = urdf_text.replace('"brush"', '"tip"').replace('"camera"', '"wrist_optical"')
    path = written(tmp_path, other)
    robot = load_robot(path, brush_site="tip", camera_site="wrist_optical")
    np.testing.assert_allclose(robot.chain.p_tool, plain.chain.p_tool)
    np.testing.assert_allclose(robot.T_brush_camera.p, plain.T_brush_camera.p)
    with pytest.raises(InputError, match=r"no site or link named 'tipp' for the brush; there are.*tip"):
        load_robot(path, brush_site="tipp")


def with_mesh(text, name, tag="collision"):
    shape = f'<{tag}><geometry><mesh filename="{name}"/></geometry></{tag}></link>'
    return text.replace('<link name="camera"/>', f'<link name="camera">{shape}')


def test_meshes_beside_the_file_and_in_packages(quick, tmp_path, urdf_text):
    folder = tmp_path / "own_description" / "urdf"
    meshes = tmp_path / "own_description" / "meshes"
    folder.mkdir(parents=True)
    meshes.mkdir()
    trimesh.creation.box((0.1, 0.04, 0.02)).export(meshes / "eye.stl")
    for name in ("../meshes/eye.stl", "package://own_description/meshes/eye.stl"):
        robot = load_robot(written(folder, with_mesh(urdf_text, name)))
        last = np.asarray(robot.spheres.center)[np.asarray(robot.spheres.frame) == 8]
        in_brush = (last - np.asarray(robot.chain.p_tool)) @ np.asarray(robot.chain.R_tool)
        mine = in_brush[np.isclose(in_brush[:, 1], -0.075, atol=1e-3)]
        # a row along its longest side, its spheres in the middles of equal lengths
        np.testing.assert_allclose(np.ptp(mine[:, 0]), 0.1 * (1 - 1 / len(mine)), atol=1e-3)
        assert len(mine) > 3
    path = written(folder, with_mesh(urdf_text, "../meshes/eye.stl", "visual"))
    model = robot_model(path)  # a picture stands for a body that says nothing of its shape
    assert (model.geom_type == int(mujoco.mjtGeom.mjGEOM_MESH)).sum() == 1


@pytest.mark.parametrize(
    ("found", "put", "message"),
    [
        ("</robot>", "", "not XML"),
        ('<robot name="big_arm">', "<model>", "not XML"),
        ('<child link="tool0"/>', '<child link="tool1"/>', "'flange' names link 'tool1', which there is not"),
        ("</robot>", '<link name="alone"/></robot>', r"2 root links \(base_link, alone\); allowed: one"),
        ('<link name="brush">', '<link name="pen">', "'brush_joint' names link 'brush'"),
        ('<mass value="13.051"/>', '<mass value="0"/>', "'shoulder_lift_link' has mass '0'"),
        ('<mass value="13.051"/>', '<mass value="nan"/>', "'shoulder_lift_link' has mass 'nan'"),
        ('velocity="2.0944"', 'velocity="0"', "'shoulder_pan_joint' has velocity 0; allowed: above 0"),
        ('effort="150"', 'effort="0"', "'elbow_joint' has effort '0'; allowed: a number above 0"),
        ('effort="150"', 'effort="nan"', "'elbow_joint' has effort 'nan'"),
        ('effort="150"', 'effort="-150"', "'elbow_joint' has effort '-150'"),
        ('effort="150"', 'effort="inf"', "'elbow_joint' has effort 'inf'"),
        (
            'lower="-3.141592653589793" upper="3.141592653589793"',
            'lower="3.1" upper="-3.1"',
            "'elbow_joint' has lower '3.1' and upper '-3.1'; allowed: lower below upper",
        ),
        (
            'lower="-3.141592653589793" upper="3.141592653589793"',
            'lower="nan" upper="3.1"',
            "'elbow_joint' has lower 'nan' and upper '3.1'",
        ),
        (
            '<limit lower="-3.141592653589793" upper="3.141592653589793" effort="150" velocity="3.1416"/>',
            "",
            "'elbow_joint' has no <limit>; allowed: lower below upper, or type continuous",
        ),
        (
            '<limit lower="-3.141592653589793" upper="3.141592653589793" effort="150"',
            '<mimic joint="shoulder_lift_joint"/><limit lower="-3" upper="3" effort="150"',
            "'elbow_joint' has a <mimic>; allowed: joints that move by themselves",
        ),
        ('effort="150"', 'effort="20"', r"joint 'elbow_joint' asks for .* N m; allowed: its limit of 20 N m"),
        ('velocity="2.0944"', 'velocity="1e6"', "speed limit of 1e.06; allowed: above 0, up to 100"),
        ('<link name="base_link">', '<link name="base_link" xmlns:xacro="urn:xacro"><xacro:tool/>', "xacro"),
        (
            "</robot>",
            '<link name="world"/><joint name="f" type="floating"><parent link="world"/>'
            '<child link="base_link"/></joint></robot>',
            "floating joint; allowed: none",
        ),
    ],
)
def test_bad_files_are_named_in_one_line(quick, tmp_path, urdf_text, found, put, message):
    assert found in urdf_text
    with pytest.raises(InputError, match=message) as caught:
        load_robot(written(tmp_path, urdf_text.replace(found, put)))
    assert "own.urdf" in str(caught.value) and "\n" not in str(caught.value)


def test_fingers_may_imitate_each_other(quick, tmp_path, urdf_text):
    """What is not on the way to the brush is not planned with."""
    finger = (
        '<link name="finger"/><joint name="finger_joint" type="prismatic"><parent link="tool0"/>'
        '<child link="finger"/><limit lower="0" upper="0" effort="0" velocity="1"/>'
        '<mimic joint="wrist_3_joint"/></joint></robot>'
    )
    robot = load_robot(written(tmp_path, urdf_text.replace("</robot>", finger)))
    assert robot.home.shape == (6,)


@pytest.mark.parametrize("encoding", ["foo", "gbk"])
@pytest.mark.parametrize("name", ["own.urdf", "own.xml"])
def test_encodings_that_are_not_read(tmp_path, urdf_text, encoding, name):
    text = urdf_text.replace('<?xml version="1.0"?>', f'<?xml version="1.0" encoding="{encoding}"?>')
    assert encoding in text
    (tmp_path / name).write_text(text)
    with pytest.raises(InputError, match="not XML") as caught:
        robot_model(tmp_path / name)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("name", "message"),
    [("none.stl", "'camera': mesh file 'none.stl' is missing"), ("eye.dae", "eye.dae'; allowed: .stl, .obj")],
)
def test_bad_meshes_are_named(quick, tmp_path, urdf_text, name, message):
    (tmp_path / "eye.dae").write_text("<COLLADA/>")
    with pytest.raises(InputError, match=message):
        load_robot(written(tmp_path, with_mesh(urdf_text, name)))


def test_a_mesh_that_is_none_is_refused(quick, tmp_path, urdf_text):
    (tmp_path / "eye.stl").write_text("solid nothing")
    with pytest.raises(InputError, match=r"own\.urdf") as caught:
        load_robot(written(tmp_path, with_mesh(urdf_text, "eye.stl")))
    assert "\n" not in str(caught.value)


def test_a_brush_is_needed(quick, tmp_path, urdf_text):
    with pytest.raises(InputError, match="no site named 'brush'"):
        load_robot(written(tmp_path, urdf_text.replace('"brush"', '"pen"')))
