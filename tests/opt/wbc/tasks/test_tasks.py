"""Single tasks: costs and rows against their equations."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from jaxpaint.kinematics import Pose, exponential, jacobian, manipulability
from opt.wbc import Reference, default_settings
from opt.wbc.tasks import base_follow, brush_twist, climb, effort

SETTINGS = default_settings()


def reference(p, R):
    return Reference(p, R, jnp.asarray([0.01, 0.02, 0.03]), jnp.asarray([0.1, 0, 0]), jnp.float32(1))


def test_the_brush_twist_is_feedforward_and_feedback_in_the_brush_frame():
    R, J = exponential(jnp.asarray([0.3, -0.5, 0.2])), jax.random.normal(jax.random.key(0), (6, 9))
    off = jnp.asarray([0.0, 0.01, -0.02])
    wanted = reference(jnp.asarray([1.0, 2, 3]) + off, R)
    rows, target, compliance = brush_twist(Pose(jnp.asarray([1.0, 2, 3]), R), J, wanted, SETTINGS)
    np.testing.assert_allclose(rows, np.concatenate([R.T @ J[:3], R.T @ J[3:]]), atol=1e-5)
    np.testing.assert_allclose(target[:3], R.T @ (wanted.velocity + 4 * off), atol=1e-5)
    np.testing.assert_allclose(target[3:], R.T @ wanted.angular_velocity, atol=1e-5)
    np.testing.assert_allclose(compliance, 1 / SETTINGS.slack_cost, rtol=1e-6)


def test_a_row_whose_slack_is_free_asks_for_nothing():
    settings = eqx.tree_at(lambda s: s.slack_cost, SETTINGS, SETTINGS.slack_cost.at[2].set(0.0))
    rows = brush_twist(
        Pose(jnp.zeros(3), jnp.eye(3)), jnp.ones((6, 9)), reference(jnp.ones(3), jnp.eye(3)), settings
    )
    assert not np.any(rows.rows[2]) and rows.target[2] == 0 and np.isfinite(rows.compliance).all()
    assert np.all(np.asarray(rows.rows)[[0, 1, 3, 4, 5]] == 1)


def test_effort_is_the_diagonal_with_and_without_a_base():
    np.testing.assert_allclose(effort(SETTINGS, 3).hessian, [0.3] * 3 + [0.01] * 6)
    np.testing.assert_allclose(effort(SETTINGS, 0).hessian, [0.01] * 6)


def test_climbing_goes_where_manipulability_grows(limits, robot):
    q = robot.at_home(jnp.zeros(3))
    task = climb(jacobian(limits.chain, q)[1], SETTINGS, 3)
    assert not np.any(task.linear[:3]) and not np.any(task.hessian)
    step = 0.01 * jnp.sign(-task.linear)
    measure = [manipulability(jacobian(limits.chain, x)[1][:, 3:], 1e-4) for x in (q - step, q, q + step)]
    assert measure[0] < measure[1] < measure[2]


def test_the_base_is_drawn_to_the_demand():
    demand = jnp.asarray([0.1, -0.2, 0.3])
    task = base_follow(demand, jnp.float32(1), SETTINGS, 6)
    free = -task.linear[:3] / task.hessian[:3]
    np.testing.assert_allclose(free, demand, rtol=1e-6)
    assert not np.any(base_follow(demand, jnp.float32(0), SETTINGS, 6).hessian)
