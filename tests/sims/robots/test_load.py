"""Robots of one's own: what is read, and what is refused."""

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest

from jaxpaint.errors import InputError
from jaxpaint.kinematics import forward, frames, jacobian, sphere_centers
from sims.robots import chain_from_model, load_robot, robot_model

# What the reference robot does not have: tilted axes, anchors, a reference angle, a slide in the arm.
ODD = """
<mujoco><worldbody><body name="b" pos="0.1 0.2 0.3" euler="10 20 30">
  <joint name="base_x" type="slide" axis="1 0 0"/><joint name="base_y" type="slide" axis="0 1 0"/>
  <joint name="base_yaw" axis="0 0 1" pos="0.05 0 0"/>
  <geom name="box" type="box" size="0.3 0.2 0.1" mass="1"/>
  <body pos="0 0 0.5" euler="0 40 0">
    <joint name="one" axis="1 2 3" pos="0.1 0.2 0" ref="30"/><joint name="two" axis="0 -1 0.5" pos="0 0 0.1"/>
    <geom type="capsule" size="0.05 0.2" mass="1"/>
    <body pos="0.3 0 0"><joint name="three" type="slide" axis="0.6 0 0.8" ref="0.1"/>
      <geom name="brush" type="sphere" size="0.05" mass="1"/>
      <site name="brush" pos="0.1 0 0" euler="15 0 5"/><site name="camera" pos="0 0.1 0"/>
    </body></body></body></worldbody>
  <keyframe><key name="home" qpos="0 0 0 0.5 0.4 0.2"/></keyframe>
</mujoco>"""

# The base's joints must act along the axes of the map.
LEVEL = ODD.replace(' euler="10 20 30"', "").replace(' pos="0.05 0 0"', "")


def mujoco_brush(model, q):
    data = mujoco.MjData(model)
    data.qpos[:] = q
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    J = np.zeros((6, model.nv))
    mujoco.mj_jacSite(model, data, J[:3], J[3:], model.site("brush").id)
    return data.site("brush").xpos.copy(), data.site("brush").xmat.reshape(3, 3).copy(), J


def test_pose_and_jacobian_equal_mujocos_at_1000_configurations():
    model, robot = robot_model(), load_robot()
    rng = np.random.default_rng(1)
    q = np.concatenate([rng.uniform(-3, 3, (1000, 3)), rng.uniform(-2 * np.pi, 2 * np.pi, (1000, 6))], 1)
    pose, J = jax.jit(jax.vmap(lambda q: jacobian(robot.chain, q)))(jnp.asarray(q, jnp.float32))
    assert pose.p.dtype == jnp.float32
    columns = [model.joint(name).dofadr[0] for name in robot.chain.names]
    for k in range(1000):
        full = np.zeros(model.nq)
        full[[model.joint(name).qposadr[0] for name in robot.chain.names]] = np.asarray(q[k], np.float32)
        p, R, expected = mujoco_brush(model, full)
        np.testing.assert_allclose(pose.p[k], p, atol=1e-5)
        np.testing.assert_allclose(pose.R[k], R, atol=1e-5)
        np.testing.assert_allclose(J[k], expected[:, columns], atol=1e-5)


def test_any_serial_chain_is_read_exactly(x64):
    model = mujoco.MjModel.from_xml_string(ODD)
    chain = chain_from_model(model, "brush")
    assert chain.kinds == ("slide", "slide", "hinge", "hinge", "hinge", "slide")
    rng = np.random.default_rng(2)
    read = jax.jit(lambda q: jacobian(chain, q))
    for q in rng.uniform(-2, 2, (20, 6)):
        pose, J = read(jnp.asarray(q))
        p, R, expected = mujoco_brush(model, q)
        np.testing.assert_allclose(pose.p, p, atol=1e-10)
        np.testing.assert_allclose(pose.R, R, atol=1e-10)
        np.testing.assert_allclose(J, expected, atol=1e-10)


def test_spheres_ride_where_mujoco_puts_the_geoms(x64, tmp_path):
    path = tmp_path / "odd.xml"
    path.write_text(LEVEL)
    model, robot = robot_model(path), load_robot(path)
    q = np.array([0.3, -0.2, 0.7, 0.4, -0.9, 0.2])
    data = mujoco.MjData(model)
    data.qpos[:] = q
    mujoco.mj_kinematics(model, data)
    centers = np.asarray(sphere_centers(robot.chain, robot.spheres, jnp.asarray(q)))
    frame = np.asarray(robot.spheres.frame)
    # the capsule's row, its ends at half its length either side
    capsule = centers[frame == 4]
    ends = data.geom_xpos[1] + 0.2 * np.outer([-1, 1], data.geom_xmat[1].reshape(3, 3)[:, 2])
    np.testing.assert_allclose([capsule[0], capsule[-1]], ends, atol=1e-9)
    # the box's cells, cubes of 0.2 m; the brush is not among the spheres
    local = (centers[frame == 2] - data.geom_xpos[0]) @ data.geom_xmat[0].reshape(3, 3)
    cells = [[x, y, 0] for x in (-0.2, 0, 0.2) for y in (-0.1, 0.1)]
    np.testing.assert_allclose(local, cells, atol=1e-9)
    np.testing.assert_allclose(np.asarray(robot.spheres.radius)[frame == 2], np.sqrt(3) * 0.1, rtol=1e-9)
    assert not (frame == 5).any()


def test_speed_limits_are_those_of_velocity_servos_alone(tmp_path):
    path = tmp_path / "odd.xml"
    servos = """<actuator>
      <position joint="one" kp="10" ctrlrange="-2 2"/><motor joint="two" ctrlrange="-9 9"/>
      <velocity joint="three" kv="10" ctrlrange="-0.2 0.3"/></actuator></mujoco>"""
    path.write_text(LEVEL.replace("</mujoco>", servos))
    np.testing.assert_allclose(load_robot(path).speed_limit[3:], [np.pi, np.pi, 0.2], rtol=1e-6)


def test_defaults_of_a_file_that_says_little(tmp_path):
    path = tmp_path / "odd.xml"
    path.write_text(LEVEL)
    robot = load_robot(path)
    np.testing.assert_allclose(robot.speed_limit, [0.5, 0.5, 1.0, *[np.pi] * 3], rtol=1e-6)
    assert np.linalg.norm(robot.drive.position, axis=1).min() > 0.2  # holonomic
    assert float(robot.drive.rate_limit) * 0.02 > np.pi
    np.testing.assert_allclose(robot.home, [0.5, 0.4, 0.2], rtol=1e-6)
    np.testing.assert_allclose(robot.T_base_lidar.p, [0, 0, 0.4], atol=1e-6)  # the box's top


@pytest.mark.parametrize(
    ("found", "put", "message"),
    [
        ('name="base_yaw"', 'name="spin"', "base_yaw.*base_x, base_y, spin"),
        ('site name="brush"', 'site name="pen"', "no site named 'brush'.*pen, camera"),
        ('site name="camera"', 'site name="eye"', "no site named 'camera'.*brush, eye"),
        ('key name="home"', 'key name="away"', "home"),
        ('type="slide" axis="0 1 0"', 'type="hinge" axis="0 1 0"', "allowed: slide, slide, hinge"),
        (
            '<site name="camera"',
            '</body><body><geom size="1"/><site name="camera"',
            "same link",
        ),
        ('type="slide" axis="0 1 0"', 'type="slide" axis="0 0 1"', "act along.*allowed: x, y and z"),
        ('type="slide" axis="0 1 0"', 'type="slide" axis="0 1 0" pos="nan 0 0"', "jnt pos is not finite"),
        ('qpos="0 0 0 0.5 0.4 0.2"', 'qpos="0 0 0 0.5"', "'home' has 4 numbers in qpos; allowed: 6"),
        ('<geom name="box"', '<inertial mass="0" pos="0 0 0" diaginertia="0 0 0"/><geom name="box"', "mass"),
        (
            LEVEL[LEVEL.index('<joint name="base_x"') : LEVEL.index('<geom name="box"')],
            '<freejoint name="base_x"/>',
            "keyframe|no joint named 'base_y'",
        ),
        (
            "</mujoco>",
            "<actuator><velocity joint='one' kv='1' ctrlrange='-999 999'/></actuator></mujoco>",
            "999",
        ),
        ('site name="brush" pos="0.1 0 0"', 'site name="brush" pos="nan 0 0"', "site pos is not finite"),
        ('euler="15 0 5"', 'quat="nan 0 0 1"', "site quat is not finite"),
        ('qpos="0 0 0 0.5 0.4 0.2"', 'qpos="0 0 0 0.5 nan 0.2"', "key qpos is not finite"),
        (
            '<geom name="box"',
            '<geom pos="inf 0 0" size="1" mass="0"/><geom name="box"',
            "geom pos is not finite",
        ),
        ('axis="1 2 3"', 'axis="1 2 3" damping="nan"', "dof damping is not finite"),
        ('axis="1 2 3"', 'axis="1 2 3" armature="nan"', "dof armature is not finite"),
        (
            "</mujoco>",
            "<actuator><velocity joint='one' kv='nan' ctrlrange='-1 1'/></actuator></mujoco>",
            "actuator gainprm is not finite",
        ),
        (
            "</mujoco>",
            "<actuator><velocity joint='one' kv='1' forcerange='-nan nan'/></actuator></mujoco>",
            "actuator forcerange is not finite|not an MJCF",
        ),
        (
            "</mujoco>",
            "<custom><numeric name='arm_acceleration' data='1 inf 1'/></custom></mujoco>",
            "'arm_acceleration' is .1.0, inf, 1.0.; allowed: 3 positive numbers",
        ),
        (
            '<worldbody><body name="b"',
            '<worldbody><site name="pen"/><body name="b"',
            "site 'brush' is fixed to the world; allowed: on the arm's last link",
        ),
        (
            "</mujoco>",
            "<actuator><motor joint='two' ctrlrange='-0.5 0.5'/></actuator></mujoco>",
            "the weight on joint 'two' asks for [0-9.]+ N m; allowed: its limit of 0.5 N m",
        ),
        (
            "</mujoco>",
            "<actuator><motor joint='three' ctrlrange='-0.5 0.5'/></actuator></mujoco>",
            "the weight on joint 'three' asks for [0-9.]+ N; allowed: its limit of 0.5 N,",
        ),
        ("</mujoco>", "", "odd.xml.*not an MJCF that MuJoCo reads"),
    ],
)
def test_bad_robots_are_named_in_one_line(tmp_path, monkeypatch, found, put, message):
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "odd.xml"
    assert found in LEVEL
    path.write_text(LEVEL.replace(found, put))
    with pytest.raises(InputError, match=message) as caught:
        load_robot(path, brush_site="pen" if 'name="pen"/><body' in put else "brush")
    assert "odd.xml" in str(caught.value) and "\n" not in str(caught.value)
    assert list(tmp_path.iterdir()) == [path], "MuJoCo's own log is kept out of the working folder"


def test_a_motor_that_just_holds_the_arm_at_home_is_taken(tmp_path):
    """The weight is MuJoCo's: with the joint's motor at just that torque, gravity and motor cancel."""
    path = tmp_path / "odd.xml"
    path.write_text(LEVEL)
    model = robot_model(path)
    data = mujoco.MjData(model)
    data.qpos[:] = [0, 0, 0, 0.5, 0.4, 0.2]
    mujoco.mj_inverse(model, data)
    need = abs(data.qfrc_inverse[model.joint("two").dofadr[0]])
    for share, taken in ((1.001, True), (0.999, False)):
        limit = f"actuatorfrcrange='{-share * need} {share * need}'"
        path.write_text(LEVEL.replace('name="two"', f'name="two" {limit}'))
        if taken:
            load_robot(path)
        else:
            with pytest.raises(InputError, match="the weight on joint 'two'"):
                load_robot(path)


def test_a_ball_in_the_arm_is_refused(tmp_path):
    path = tmp_path / "odd.xml"
    without_home = LEVEL[: LEVEL.index("<keyframe>")] + "</mujoco>"
    path.write_text(without_home.replace('name="three" type="slide"', 'name="three" type="ball"'))
    with pytest.raises(InputError, match="'three' is free or a ball"):
        load_robot(path)


def test_no_such_file(tmp_path):
    with pytest.raises(InputError, match=r"none\.xml.*no such file"):
        load_robot(tmp_path / "none.xml")


def test_a_robot_is_arrays_and_names_alone():
    robot = load_robot()
    assert all(isinstance(leaf, jax.Array) and not leaf.weak_type for leaf in jax.tree.leaves(robot))
    traces = 0

    @jax.jit
    def tip(robot):
        nonlocal traces
        traces += 1
        return forward(robot.chain, robot.at_home(jnp.zeros(3))).p, frames(
            robot.chain, robot.at_home(jnp.zeros(3))
        ).p

    tip(robot)
    tip(jax.tree.map(lambda x: x * 1, robot))
    assert traces == 1
