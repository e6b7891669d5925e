"""A simulated robot with position servos follows the plan, or shows that it cannot."""

import dataclasses
from pathlib import Path

import mujoco
import numpy as np
import pytest

from experiments.exports import replay as module
from experiments.exports import write_table
from experiments.exports.replay import main, replay, servo_model
from jaxpaint.errors import InputError
from sims.painting.joint_plan import JointTrajectory, smooth_trajectory

URDF = Path(__file__).resolve().parents[2] / "robots" / "big_arm.urdf"


def test_the_brush_follows_within_a_millimetre(waving):
    found = replay(waving)
    assert found.pen.sum() * module.STEP == pytest.approx(2.0, abs=0.06)
    assert np.ptp(found.planned[found.pen], axis=0).max() > 0.1, "it moves"
    assert found.error.max() < 1e-3


def test_gravity_is_on_and_servos_are_what_holds_the_arm(waving):
    model = servo_model(waving.names)
    assert model.opt.gravity[2] == pytest.approx(-9.81)
    assert model.nu == len(waving.names)
    np.testing.assert_array_equal(model.actuator_trnid[:, 0], [model.joint(n).id for n in waving.names])
    assert (model.actuator_gainprm[:, 0] > 0).all()
    assert model.actuator_forcerange[model.actuator("elbow").id].tolist() == [-150, 150]


def test_the_servos_carry_the_weight(waving):
    """At rest with the arm stretched out, their torques are what gravity asks for."""
    model = servo_model(waving.names)
    data = mujoco.MjData(model)
    place = [model.joint(name).qposadr[0] for name in waving.names]
    data.qpos[place] = data.ctrl[:] = [0, 0, 0, 0, -0.5, 1.0, 0, 0, 0]
    for _ in range(1000):
        mujoco.mj_step(model, data)
    shoulder = model.joint("shoulder_lift").dofadr[0]
    assert abs(data.qfrc_bias[shoulder]) > 20
    assert data.qfrc_actuator[shoulder] == pytest.approx(data.qfrc_bias[shoulder], rel=0.02)
    assert not data.qfrc_gravcomp.any()


def test_what_no_servo_can_follow_is_seen(waving):
    fast = dataclasses.replace(
        waving, time=waving.time / 6, velocity=waving.velocity * 6, acceleration=waving.acceleration * 36
    )
    assert replay(fast).error.max() > 3e-3


def test_derivatives_that_do_not_belong_to_the_positions_are_seen(waving):
    wrong = dataclasses.replace(waving, velocity=np.zeros_like(waving.velocity))
    assert replay(wrong).error.max() > 2 * replay(waving).error.max()


def test_another_robot_needs_the_joints_of_the_plan(waving, tmp_path):
    spec = mujoco.MjSpec.from_file(str(module.REFERENCE))
    spec.joint("elbow").name = "knee"
    spec.actuator("elbow").target = "knee"
    path = tmp_path / "robot.xml"
    path.write_text(spec.to_xml())
    with pytest.raises(InputError, match="'elbow'"):
        replay(waving, path)


def test_the_script_prints_the_error(waving, tmp_path, capsys):
    write_table(waving, tmp_path / "trajectory.csv")
    assert main([str(tmp_path / "trajectory.csv")]) == 0
    assert "mm" in capsys.readouterr().out


@pytest.fixture(scope="module")
def reaching() -> JointTrajectory:
    """Two seconds of the test arm, whose URDF has neither base joints nor actuators."""
    names = ("base_x", "base_y", "base_yaw", "shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint")
    time = np.linspace(0, 2, 41)
    reach = np.array([0.1, 0.1, 0.1, 0.2, -0.2, 0.2])
    position = np.array([0, 0, 0, 0, -1.2, 1.8]) + reach * (np.sin(np.pi * time / 2) ** 4)[:, None]
    return smooth_trajectory(names, ("m", "m", *["rad"] * 4), time, position, time >= 0.5)


def test_a_urdf_is_replayed_by_the_link_that_is_its_brush(reaching, tmp_path, capsys):
    write_table(reaching, tmp_path / "trajectory.csv")
    found = []
    for brush in ("tool0", "brush"):
        assert main([str(tmp_path / "trajectory.csv"), str(URDF), "--brush-site", brush]) == 0
        found.append(float(capsys.readouterr().out.split("largest")[1].split()[0]))
    assert 0 < found[0] < 3.0
    assert found[0] != found[1], "another point of the robot"


def test_the_brush_may_have_another_name(waving, tmp_path):
    spec = mujoco.MjSpec.from_file(str(module.REFERENCE))
    spec.site("brush").name = "tip"
    path = tmp_path / "robot.xml"
    path.write_text(spec.to_xml())
    with pytest.raises(InputError, match="--brush-site"):
        replay(waving, path)
    np.testing.assert_allclose(replay(waving, path, "tip").error, replay(waving).error, atol=1e-8)


def test_bad_input_is_one_line_and_status_2(reaching, waving, tmp_path, capsys):
    write_table(reaching, tmp_path / "urdf.csv")
    write_table(waving, tmp_path / "reference.csv")
    up = dataclasses.replace(waving, pen=np.zeros_like(waving.pen))
    write_table(up, tmp_path / "up.csv")
    here = str(tmp_path)
    for words, said in (
        ([], "usage"),
        ([f"{here}/nowhere.csv"], "No such file"),
        ([f"{here}/urdf.csv"], "'shoulder_pan_joint'"),
        ([f"{here}/urdf.csv", str(URDF), "--brush-site", "tip"], "'tip'"),
        ([f"{here}/reference.csv", "nowhere.xml"], "no such file"),
        ([f"{here}/reference.csv", "--brush", "brush"], "--brush"),
        ([f"{here}/up.csv"], "pen down"),
    ):
        assert main(words) == 2
        shown = capsys.readouterr()
        assert shown.out == ""
        assert len(shown.err.splitlines()) == 1
        assert said in shown.err
