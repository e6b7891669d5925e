"""Robots that are not the reference: what is read is what MuJoCo has, and they can paint."""

import jax
import jax.numpy as jnp
import mujoco
import numpy as np

from jaxpaint.compiling import batched
from jaxpaint.kinematics import IKSettings, Pose, forward, frame_from_axis, jacobian, manipulability, solve
from sims.limits import robot_limits
from sims.robots import check_can_paint, robot_model

AHEAD, RIGHT = np.array([1.0, 0, 0]), np.array([0, -1.0, 0])


def test_pose_and_jacobian_are_mujocos(own):
    path, robot = own
    model = robot_model(path)
    data, site = mujoco.MjData(model), model.site("brush").id
    names = robot.chain.names
    rng = np.random.default_rng(3)
    low = np.concatenate([[-1, -1, -3], np.maximum(np.asarray(robot.lower), -6)])
    high = np.concatenate([[1, 1, 3], np.minimum(np.asarray(robot.upper), 6)])
    q = rng.uniform(low, high, (50, len(names))).astype(np.float32)
    pose, J = jax.jit(jax.vmap(lambda q: jacobian(robot.chain, q)))(q)
    for k, row in enumerate(q):
        for name, value in zip(names, row, strict=True):
            data.joint(name).qpos = value
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        full = np.zeros((6, model.nv))
        mujoco.mj_jacSite(model, data, full[:3], full[3:], site)
        np.testing.assert_allclose(pose.p[k], data.site_xpos[site], atol=1e-5)
        np.testing.assert_allclose(pose.R[k], data.site_xmat[site].reshape(3, 3), atol=1e-5)
        np.testing.assert_allclose(J[k], full[:, [model.joint(n).dofadr[0] for n in names]], atol=1e-5)


def test_home_is_level_ahead_and_clear(own):
    _, robot = own
    check_can_paint(robot)
    brush = forward(robot.chain, robot.at_home(jnp.zeros(3)))
    np.testing.assert_allclose(brush.R, frame_from_axis(AHEAD, RIGHT), atol=2e-3)
    assert float(robot.footprint[:, 0].max()) + 0.2 < brush.p[0] < 1.3
    assert float(jnp.minimum(robot.upper - robot.home, robot.home - robot.lower).min()) >= 0
    np.testing.assert_allclose(robot_limits(robot).home, brush.p[:2], atol=1e-5)


def test_a_wall_around_home_is_reached(own):
    """0.25 m to all sides, from home, within the joints' limits, and never near a singular posture."""
    _, robot = own
    arm = robot.arm(jnp.zeros(3))
    middle = forward(arm, robot.home).p
    R = frame_from_axis(jnp.asarray(AHEAD, jnp.float32), jnp.asarray(RIGHT, jnp.float32))
    box = jnp.asarray([[0, y, z] for y in (-0.25, 0.0, 0.25) for z in (-0.25, 0.0, 0.25)]) + middle

    def reach(p):
        found = solve(arm, robot.home[None], Pose(p, R), robot.lower, robot.upper, IKSettings(iterations=40))
        return found.q, found.converged, manipulability(jacobian(arm, found.q)[1])

    q, converged, measure = batched(reach, in_axes=(0,), chunk=9)(box)
    assert bool(converged.all())
    assert float(measure.min()) > 0.01
    assert bool(((q >= robot.lower) & (q <= robot.upper)).all())
