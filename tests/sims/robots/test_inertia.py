"""Inverse dynamics of the robot against MuJoCo's, and the limits that the file sets."""

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest

from jaxpaint.kinematics import inverse_dynamics
from sims.robots import chain_from_model, robot_model
from sims.robots.inertia import inertia_from_model, torque_limits
from sims.robots.model import find, joints_to


def _joints(model, site="brush"):
    return joints_to(model, int(model.site_bodyid[find(model, mujoco.mjtObj.mjOBJ_SITE, site)]))


def _mujoco(model, dof, rows):
    """Motor torques of mj_inverse, with nothing but the motors to hold the robot up."""
    model.body_gravcomp[:] = 0
    data, out = mujoco.MjData(model), []
    for q, v, a in rows:
        data.qpos[:] = data.qvel[:] = data.qacc[:] = 0
        data.qpos[dof], data.qvel[dof], data.qacc[dof] = q, v, a
        mujoco.mj_inverse(model, data)
        out.append(data.qfrc_inverse[dof].copy())
    return np.array(out)


def _ours(model, joints, rows, site="brush"):
    chain, inertia = chain_from_model(model, site), inertia_from_model(model, joints)
    one = jax.jit(jax.vmap(lambda row: inverse_dynamics(chain, inertia, *row)))
    return np.asarray(one(jnp.asarray(rows)))


def test_the_reference_robot_as_mj_inverse(x64):
    model = robot_model()
    joints = _joints(model)
    rows = np.random.default_rng(0).uniform(-3, 3, (200, 3, len(joints)))
    wanted = _mujoco(model, model.jnt_dofadr[joints], rows)
    assert np.abs(wanted).max() > 100
    np.testing.assert_allclose(_ours(model, joints, rows), wanted, atol=1e-8 * np.abs(wanted).max())


def test_in_single_precision_far_from_the_map_origin():
    model = robot_model()
    joints = _joints(model)
    rows = np.random.default_rng(1).uniform(-3, 3, (50, 3, len(joints)))
    rows[:, 0, :2] += 20
    wanted = _mujoco(model, model.jnt_dofadr[joints], rows)
    found = _ours(model, joints, rows.astype(np.float32))
    np.testing.assert_allclose(found[:, 3:], wanted[:, 3:], atol=2e-3)


ODD = """<mujoco><worldbody><body name="a" pos="0.1 0 0.2"><joint name="s" type="slide" axis="1 2 0"/>
<geom type="box" size="0.1 0.2 0.05" pos="0.1 0 0" mass="3"/><body pos="0 0.2 0" euler="20 40 0">
<geom type="sphere" size="0.1" mass="1.5"/>
<body pos="0.3 0 0.1"><joint name="h" axis="0.3 -1 0.2" pos="0.05 0 0" armature="0.2" damping="0.4"
actuatorfrcrange="-7 9"/><geom type="capsule" size="0.03" fromto="0 0 0 0.4 0 0.2" mass="2"/>
<site name="tip" pos="0.4 0 0.2"/></body></body></body></worldbody>
<actuator><motor joint="s" gear="3" ctrlrange="-2 2"/>
<general joint="h" forcerange="-20 20" gainprm="1"/></actuator></mujoco>"""


def test_slides_odd_axes_and_welded_bodies(x64):
    model = mujoco.MjModel.from_xml_string(ODD)
    rows = np.random.default_rng(2).uniform(-2, 2, (50, 3, 2))
    np.testing.assert_allclose(
        _ours(model, [0, 1], rows, "tip"), _mujoco(model, np.arange(2), rows), atol=1e-10
    )


def test_limits_come_from_actuators_and_joints():
    model = robot_model()
    np.testing.assert_allclose(torque_limits(model, _joints(model)), [2000] * 3 + [150] * 3 + [28] * 3)
    odd = mujoco.MjModel.from_xml_string(ODD)
    np.testing.assert_allclose(torque_limits(odd, [0, 1]), [6, 7])
    free = mujoco.MjModel.from_xml_string(ODD.split("<actuator>")[0] + "</mujoco>")
    assert torque_limits(free, [0, 1]) == pytest.approx([np.inf, 7])
