"""One physics step after another, held against MuJoCo in C in float64."""

import copy

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest

from jaxpaint.compiling import batched
from sims.robots import load_robot, robot_model
from sims.wheeled import Bump, Flat, Motion, Ramp, at_rest, wheeled, wheeled_model
from sims.wheeled.in_c import in_c

STEP, STEPS, WORLDS = 0.005, 120, 2


def told(physics, home, weight):
    """Wheels that turn and roll while the arm is held: control of every servo. [worlds, STEPS, servos]"""
    kp, kv = np.asarray(physics.position_gain), np.asarray(physics.velocity_gain)
    time = np.arange(STEPS) * STEP
    ctrl = np.zeros((WORLDS, STEPS, len(kp)))
    for k in range(WORLDS):
        steer = 0.4 * (k + 1) * np.array([-1, 1, 1, -1]) * np.clip(time / 0.3, 0, 1)[:, None]
        rate = 0.4 * (k + 1) * np.array([-1, 1, 1, -1]) / 0.3 * (time < 0.3)[:, None]
        spin = 3.0 * np.clip((time - 0.1) / 0.3, 0, 1)[:, None] * np.ones(4)
        ctrl[k, :, 0:8:2] = kp[0:8:2] * steer + kv[0:8:2] * rate
        ctrl[k, :, 1:8:2] = kp[1:8:2] * np.cumsum(spin, axis=0) * STEP + kv[1:8:2] * spin
    ctrl[..., 8:] = kp[8:] * home + weight
    return ctrl


@pytest.mark.parametrize(
    "floor", [Flat(), Ramp(start=(0.4, 0.0), yaw=0.0), Bump(center=(0.62, 0.0), yaw=np.pi / 2)]
)
def test_rolls_turns_and_slides_as_in_c(x64, floor):
    robot = load_robot()
    home = np.asarray(robot.home, float)
    sunk = at_rest(wheeled_model(robot_model()), home)
    rolling = wheeled_model(robot_model(), floor, height=-sunk.tilt[0])
    fidelity = wheeled(robot_model(), home, floor=floor)
    physics = jax.tree.map(lambda x: jnp.asarray(x, float), fidelity.physics)
    engine, model = fidelity.engine, in_c(rolling, physics, STEP)
    data = mujoco.MjData(model)
    data.qpos[15:] = home
    mujoco.mj_forward(model, data)
    start, ctrl = data.qpos.copy(), told(physics, home, data.qfrc_bias[14:].copy())

    def roll(physics, q, ctrl):
        made = engine.with_physics(physics, jnp.asarray(STEP))
        first = Motion(q, jnp.zeros(20), jnp.zeros(20))

        def step(state, row):
            state = engine.advance(made, state, row, jnp.zeros(14))
            return state, state.q

        return jax.lax.scan(step, first, ctrl)[1]

    run = batched(roll, in_axes=(None, 0, 0), chunk=1)
    found = np.asarray(run(physics, jnp.asarray(np.tile(start, (WORLDS, 1))), jnp.asarray(ctrl)))
    for k in range(WORLDS):
        data = mujoco.MjData(model)
        data.qpos[:] = start
        rows = []
        for row in ctrl[k]:
            data.ctrl[:] = row
            mujoco.mj_step(model, data)
            rows.append(data.qpos.copy())
        assert abs(rows[-1][0] - start[0]) > 0.05
        np.testing.assert_allclose(found[k], rows, atol=2e-6)


def test_equal_models_are_equal_engines():
    home = np.asarray(load_robot().home, float)
    one, two = (wheeled(robot_model(), home).engine for _ in range(2))
    assert one == two and hash(one) == hash(two)
    other = wheeled(robot_model(), home, floor=Ramp()).engine
    assert other != one and copy.copy(one) == one
