"""The model of a planar base and an arm against the robot's whole model."""

from pathlib import Path

import mujoco
import numpy as np
import pytest

from jaxpaint.errors import InputError
from sims.dynamics import Engine, physics_of, planar_model
from sims.robots import robot_model
from sims.robots.model import joints_to

ROBOTS = Path(__file__).resolve().parents[2] / "robots"
FILES = [
    None,
    ROBOTS / "seven_joints.xml",
    ROBOTS / "mecanum.xml",
    ROBOTS / "big_arm.urdf",
    ROBOTS / "big_arm.xml",
]


def chain_joints(model):
    return joints_to(model, int(model.site_bodyid[model.site("brush").id]))


def full_mass(model, data):
    out = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, out)
    return out


@pytest.mark.parametrize("file", FILES, ids=lambda f: f.stem if f else "reference")
def test_inertia_weight_and_coriolis_are_the_robots(file):
    """Where only the chain moves, the joints beside it held at zero."""
    model = robot_model(file)
    planar = planar_model(model)
    joints = chain_joints(model)
    dofs, places = model.jnt_dofadr[joints], model.jnt_qposadr[joints]
    assert [planar.joint(i).name for i in range(planar.njnt)] == [model.joint(j).name for j in joints]
    assert planar.ngeom == planar.ncam == 0 and planar.nu == planar.nv == len(joints)
    rng = np.random.default_rng(0)
    for _ in range(3):
        whole, ours = mujoco.MjData(model), mujoco.MjData(planar)
        whole.qpos[:] = 0
        ours.qpos[:] = whole.qpos[places] = rng.uniform(-1, 1, len(joints))
        ours.qvel[:] = whole.qvel[dofs] = rng.uniform(-1, 1, len(joints))
        mujoco.mj_forward(model, whole)
        mujoco.mj_forward(planar, ours)
        mass = full_mass(model, whole)[np.ix_(dofs, dofs)]
        np.testing.assert_allclose(full_mass(planar, ours), mass, atol=2e-6 * np.abs(mass).max())
        bias = whole.qfrc_bias[dofs]
        np.testing.assert_allclose(ours.qfrc_bias, bias, atol=1e-5 * np.abs(bias).max())


def test_servos_have_the_files_gains_and_limits():
    planar = planar_model(robot_model())
    physics = physics_of(planar, position_rate=20.0)
    np.testing.assert_allclose(physics.velocity_gain, [4000] * 3 + [800] * 3 + [150] * 3)
    np.testing.assert_allclose(physics.position_gain, [16000] * 3 + [3000] * 3)
    np.testing.assert_allclose(physics.force_limit, [2000] * 3 + [150] * 3 + [28] * 3)


def test_a_file_without_servos_gets_stiff_ones():
    model = robot_model()
    model.actuator_biasprm[:] = 0
    planar = planar_model(model)
    data = mujoco.MjData(planar)
    mujoco.mj_forward(planar, data)
    time_constant = np.diag(full_mass(planar, data)) / np.asarray(physics_of(planar).velocity_gain)
    np.testing.assert_allclose(time_constant, 0.005, rtol=1e-4)


def test_equal_models_are_one_program():
    a, b = (Engine(planar_model(robot_model())) for _ in range(2))
    other = Engine(planar_model(robot_model(ROBOTS / "mecanum.xml")))
    assert a == b and hash(a) == hash(b) and a != other


def test_a_gear_multiplies_a_servos_gain_by_its_square():
    model = robot_model()
    servo = model.actuator("elbow").id
    model.actuator_gear[servo, 0] = -10
    physics = physics_of(planar_model(model))
    np.testing.assert_allclose(physics.velocity_gain[5], 100 * 800)
    np.testing.assert_allclose(physics.force_limit[5], 10 * 150)


def rotations(count):
    """Rotations in space, drawn evenly, as quaternions."""
    quats = np.random.default_rng(0).normal(size=(count, 4))
    return quats / np.linalg.norm(quats, axis=1, keepdims=True)


@pytest.mark.parametrize("moments", [(0.05, 0.05, 0.1), (0.1, 0.2, 0.3), (0.1, 0.1, 0.1), (1e-7, 3e-7, 4e-7)])
def test_flat_bodies_in_any_orientation_are_taken(moments):
    """Their largest moment is the sum of the others: rounding must not refuse them, nor change them."""
    text = (ROBOTS / "mecanum.xml").read_text()
    first = text.index("<inertial")
    last = text.index("/>", first)
    for quat in rotations(30):
        inertial = (
            f'<inertial mass="3" pos="0.01 0.02 0.03" quat="{" ".join(map(str, quat))}" '
            f'diaginertia="{" ".join(map(str, moments))}"'
        )
        model = mujoco.MjModel.from_xml_string(text[:first] + inertial + text[last:])
        planar = planar_model(model)
        np.testing.assert_allclose(np.sort(planar.body_inertia[2]), np.sort(moments), rtol=1e-9)


def test_what_mujoco_refuses_is_bad_input():
    model = robot_model()
    model.body_inertia[model.body("upper_arm").id] = [0.1, 0.1, 0.5]
    with pytest.raises(InputError, match="inertia") as caught:
        planar_model(model)
    assert "\n" not in str(caught.value)
