"""Dynamics on trees of joints, held against MuJoCo in float64."""

import jax.numpy as jnp
import mujoco
import numpy as np
import pytest

from jaxpaint.kinematics.rotations import rotation_from_quaternion
from sims.dynamics import planar_model
from sims.dynamics.tree import Masses, Tree
from sims.robots import robot_model
from sims.wheeled import wheeled_model


def state_of(model, seed):
    data, rng = mujoco.MjData(model), np.random.default_rng(seed)
    data.qpos[:] = rng.normal(size=model.nq)
    mujoco.mj_normalizeQuat(model, data.qpos)
    data.qvel[:] = rng.normal(size=model.nv)
    mujoco.mj_forward(model, data)
    return data


def placed_by(tree, model, data):
    qpos = jnp.asarray(data.qpos)
    masses = Masses(*(jnp.asarray(x[1:]) for x in (model.body_mass, model.body_ipos, model.body_inertia)))
    if not tree.free:
        return tree.place(masses, (jnp.eye(3), jnp.zeros(3)), qpos)
    return tree.place(masses, (rotation_from_quaternion(qpos[3:7]), qpos[:3]), qpos[7:])


@pytest.mark.parametrize("make", [planar_model, wheeled_model])
@pytest.mark.parametrize("seed", [0, 1])
def test_inertia_bias_and_weight_are_mujocos(x64, strict_ranks, make, seed):
    model = make(robot_model())
    data, tree = state_of(model, seed), Tree(model)
    placed = placed_by(tree, model, data)
    R, p = tree.bodies(placed)
    np.testing.assert_allclose(p, data.xpos[1:], atol=1e-13)
    np.testing.assert_allclose(R.reshape(-1, 9), data.xmat[1:], atol=1e-13)
    np.testing.assert_allclose(placed.screw, data.cdof, atol=1e-12)
    carried = tree.composite(placed.spatial)
    full = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, full)
    np.testing.assert_allclose(
        tree.inertia(placed, carried, jnp.asarray(model.dof_armature)), full, atol=1e-11
    )
    gravity = jnp.asarray(np.array(model.opt.gravity))
    np.testing.assert_allclose(tree.bias(placed, jnp.asarray(data.qvel), gravity), data.qfrc_bias, atol=1e-10)
    data.qvel[:] = 0
    mujoco.mj_forward(model, data)
    np.testing.assert_allclose(tree.weight(placed, carried, gravity), data.qfrc_bias, atol=1e-11)
