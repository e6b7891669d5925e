"""Fidelity `dynamic`: the physics is MuJoCo's, the servos do what they are told within their forces."""

import equinox as eqx
import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest

from jaxpaint.kinematics import forward
from sims.dynamics import planar_model
from sims.dynamics.servos import load_of
from sims.noise import noise_preset

DT, STEPS = 0.02, 52
SUBSTEPS = 4


def waves(rows, amplitude):
    """Adds smooth joint speeds of the arm to the plan; positions follow."""
    time = DT * np.arange(STEPS)[:, None]
    speed = amplitude * np.sin(2 * time + np.arange(6))
    rows = rows.copy()
    rows[..., 12:18] = speed
    rows[..., 3:9] += np.concatenate([np.zeros((1, 6)), np.cumsum(speed[:-1], axis=0)]) * DT
    return rows


def weight(planar, q):
    """Motor torques at rest: MuJoCo's own bias forces without speeds."""
    still = mujoco.MjData(planar)
    still.qpos[:] = q
    mujoco.mj_forward(planar, still)
    return still.qfrc_bias[3:]


def in_c(bench, rows, q, physics=None):
    """The same servos on MuJoCo in C, base held at rest by its own, sideways and in yaw by its tyres.

    What balances the weight is a part of what the motors are told, and so within MuJoCo's force ranges.
    """
    planar = planar_model(bench.model)
    physics = jax.tree.map(np.asarray, bench.fidelity.physics if physics is None else physics)
    planar.opt.timestep = DT / SUBSTEPS
    planar.actuator_biasprm[3:, 1] = -physics.position_gain
    planar.actuator_forcerange[:] = physics.force_limit[:, None] * [-1, 1]
    balanced = 1 - float(physics.gravity_error)
    data = mujoco.MjData(planar)
    data.qpos[:] = q
    goal, pace = q[3:].astype(float), np.zeros(6)
    change = np.asarray(bench.limits.arm_acceleration) * DT / SUBSTEPS
    after = np.concatenate([rows[1:], rows[-1:]])
    for speed in (rows + after)[:, 12:18] / 2:  # what the controller commands
        before = data.qpos[:3].copy()
        for _ in range(SUBSTEPS):
            pace = pace + np.clip(speed - pace, -change, change)
            goal = goal + pace * DT / SUBSTEPS
            goal = np.clip(goal, data.qpos[3:] - 0.1, data.qpos[3:] + 0.1)
            data.ctrl[3:] = physics.position_gain * goal + physics.velocity_gain[3:] * pace
            data.ctrl[3:] += balanced * weight(planar, data.qpos)
            mujoco.mj_step(planar, data)
        wheels = np.asarray(bench.limits.drive.position, float)
        data.qpos[:3] = before + kept(wheels, data.qpos[:3] - before)
        data.qvel[:3] = kept(wheels, data.qvel[:3])
    return data.qpos, data.qvel


def kept(wheels, motion, angle=0.0):
    """What of a base's motion wheels at these places roll, all turned by `angle`; the base has hardly turned.

    Each contact moves as the twist says; the part along its wheel is what a twist is fitted to.
    """
    moves = np.concatenate([[[1, 0, -b], [0, 1, a]] for a, b in wheels])
    ahead = np.array([np.cos(angle), np.sin(angle)])
    along = (moves @ motion).reshape(-1, 2) @ ahead
    return np.linalg.lstsq(moves, np.outer(along, ahead).ravel(), rcond=None)[0]


def test_agrees_with_mujoco_in_c(bench, resting):
    rng = np.random.default_rng(0)
    starts = np.tile(np.asarray(bench.robot.at_home(jnp.zeros(3))), (4, 1))
    starts[:, 3:] += rng.uniform(-0.3, 0.3, (4, 6))
    plans = np.concatenate([waves(resting, 0.4 * k) for k in (1, -1, 0.5, 0.0)])
    state, _ = bench(plans, world=starts)
    assert (np.asarray(state.diverged_at) == -1).all()
    for i in range(4):
        q, v = in_c(bench, plans[i], starts[i])
        np.testing.assert_allclose(state.world.arm[i], q[3:], atol=2e-5)
        np.testing.assert_allclose(state.world.arm_velocity[i], v[3:], atol=2e-4)
        np.testing.assert_allclose(state.world.base[i], q[:3], atol=5e-6)
        assert np.abs(q[:3]).max() > 2e-5 or i == 3  # the arm's recoil moves the base


def test_the_arm_sags_by_its_uncompensated_weight_over_its_stiffness(bench, resting):
    state, _ = bench(resting)
    planar = planar_model(bench.model)
    data = mujoco.MjData(planar)
    data.qpos[:] = bench.robot.at_home(jnp.zeros(3))
    mujoco.mj_forward(planar, data)
    physics = bench.fidelity.physics
    load = float(physics.gravity_error) * data.qfrc_bias[3:]
    sag = np.asarray(state.world.arm[0] - bench.robot.home)
    np.testing.assert_allclose(sag, -load / np.asarray(physics.position_gain), rtol=0.02, atol=2e-6)
    assert 1e-5 < np.abs(sag).max() < 1e-3


def test_a_robot_without_servos_keeps_its_energy(bench, resting):
    """It falls freely, base and all: kinetic and potential energy add up to what they were."""
    free = eqx.tree_at(
        lambda p: (p.velocity_gain, p.position_gain, p.damping, p.gravity_error),
        bench.fidelity.physics,
        (jnp.zeros(9), jnp.zeros(6), jnp.zeros(9), jnp.ones(())),
    )
    state, _ = bench(resting, physics=free)
    planar = planar_model(bench.model)
    planar.opt.enableflags |= int(mujoco.mjtEnableBit.mjENBL_ENERGY)
    data = mujoco.MjData(planar)

    def energy(q, v):
        data.qpos[:], data.qvel[:] = q, v
        mujoco.mj_forward(planar, data)
        return np.array(data.energy)

    before = energy(np.asarray(bench.robot.at_home(jnp.zeros(3))), np.zeros(9))
    w = state.world
    base = np.asarray(w.base[0])
    c, s = np.cos(base[2]), np.sin(base[2])
    x, y, turn = np.asarray(w.servos.rolling[0])
    after = energy(
        np.concatenate([base, w.arm[0]]),
        np.concatenate([[c * x - s * y, s * x + c * y, turn], w.arm_velocity[0]]),
    )
    assert after[1] > 10  # it fell
    assert abs(after.sum() - before.sum()) < 0.03 * after[1]


def test_the_brush_follows_a_plan(bench, resting):
    plan = waves(resting, 0.3)
    plan[..., 9] = 0.1 * np.minimum(1, DT * np.arange(STEPS) / 0.4)
    plan[:, 1:, 0] = np.cumsum(plan[:, :-1, 9], axis=1) * DT
    _, record = bench(plan, gain=2.0)
    rows = np.asarray(record.planned[0])
    q = np.concatenate([record.base[0], record.arm[0]], axis=1)
    brush = np.stack([np.asarray(forward(bench.robot.chain, jnp.asarray(x)).p) for x in q])
    off = np.linalg.norm(brush - rows, axis=1)
    assert np.linalg.norm(rows[-1] - rows[0]) > 0.1
    assert off.max() < 0.006 and off[-1] < 0.004


def test_a_weak_servo_falls_behind_and_winds_nothing_up(bench, resting):
    plan = waves(resting, 1.0)
    weak = eqx.tree_at(lambda p: p.force_limit, bench.fidelity.physics, jnp.full(9, 0.5))
    behind, _ = bench(plan, physics=weak)
    strong, _ = bench(plan)
    assert np.abs(behind.world.arm - strong.world.arm).max() > 0.05
    held = np.abs(behind.world.servos.reference - behind.world.arm).max()
    assert held < 0.12


@pytest.mark.parametrize("share", [0.5, 0.0])
def test_motors_too_weak_for_the_weight_let_the_arm_sink(bench, resting, share):
    """As it does in C: the limit holds for what balances the weight too, and a servo at it damps nothing."""
    planar = planar_model(bench.model)
    home = np.asarray(bench.robot.at_home(jnp.zeros(3)))
    needed = np.abs(weight(planar, home))
    limit = np.asarray(bench.fidelity.physics.force_limit).copy()
    limit[4:6] = share * needed[1:3]  # shoulder and elbow
    weak = eqx.tree_at(lambda p: p.force_limit, bench.fidelity.physics, jnp.asarray(limit))
    state, _ = bench(resting, physics=weak)
    q, _ = in_c(bench, resting[0], home, weak)
    fallen = state.world.arm[0] - bench.robot.home
    assert np.abs(fallen).max() > 0.5
    np.testing.assert_allclose(state.world.arm[0], q[3:], atol=2e-3 * np.abs(fallen).max())
    height = forward(bench.robot.chain, jnp.concatenate([state.world.base[0], state.world.arm[0]])).p[2]
    assert height < 1.1 - 0.2


def test_the_arm_balances_the_weight_that_it_was_told_of(bench):
    """Half of the masses more than it was told: it falls as half of the masses would."""
    engine, physics = bench.fidelity.engine, bench.fidelity.physics
    heavier = eqx.tree_at(lambda p: p.mass, physics, 1.5 * physics.mass)
    q, still = bench.robot.at_home(jnp.zeros(3)), jnp.zeros(9)

    def speed(balanced, told):
        one = jnp.asarray(1e-3)
        model = engine.with_physics(heavier, one)
        hold = jnp.concatenate([jnp.zeros(3), physics.position_gain * q[3:]])
        return np.asarray(jax.jit(engine.advance)(model, q, still, hold, balanced, told)[1])

    told = load_of(physics)
    np.testing.assert_allclose(speed(1.0, told), speed(2 / 3, None), atol=1e-6)
    assert np.abs(speed(1.0, None)).max() < 1e-6 < 1e-3 < np.abs(speed(1.0, told)).max()


def test_slip_acts_once_and_odometry_reports_what_rolled(bench, resting):
    plan = resting.copy()
    plan[..., 9] = 0.1
    state, _ = bench(plan, slip=1.2)
    rolled, true = np.asarray(state.world.odometry[0]), np.asarray(state.world.base[0])
    assert 0.08 < rolled[0] < 0.104
    np.testing.assert_allclose(true[0], 1.2 * rolled[0], rtol=2e-3)


def test_creep_is_not_measured(bench, resting):
    """Below the dead band; the base lacks what it takes to gather speed."""
    plan = resting.copy()
    plan[..., 9] = 0.004
    band = noise_preset("s1-simulation").odometry.dead_band
    assert band > 0.004
    state, _ = bench(plan, noise=eqx.tree_at(lambda n: n.dead_band, bench.noise, band))
    assert float(state.world.odometry[0, 0]) == 0
    assert float(state.world.base[0, 0]) == pytest.approx(0.004 * DT * STEPS, rel=0.01)


def test_a_world_that_diverges_is_marked_and_changes_no_other(bench, resting):
    plans = np.concatenate([waves(resting, 0.1 * k) for k in range(4)])
    physics = jax.tree.map(lambda x: jnp.tile(x, (4,) + (1,) * x.ndim), bench.fidelity.physics)
    fine, seen = bench(plans, physics=physics)
    # no inertia that the servos' own could make good: the mass matrix has no factors
    broken = eqx.tree_at(lambda p: p.armature, physics, physics.armature.at[2, 3].set(-50.0))
    state, record = bench(plans, physics=broken)
    kept = [0, 1, 3]
    np.testing.assert_array_equal(np.asarray(state.diverged_at) >= 0, [False, False, True, False])
    for a, b in ((state.world, fine.world), (record, seen)):
        jax.tree.map(lambda x, y: np.testing.assert_array_equal(x[kept,], y[kept,]), *map(to_numpy, (a, b)))


def to_numpy(tree):
    return jax.tree.map(np.asarray, tree)


def test_nothing_was_compiled_anew(bench, resting):
    bench(resting)
    traces = bench.run.traces
    heavier = eqx.tree_at(
        lambda p: (p.mass, p.damping), bench.fidelity.physics, (jnp.full(7, 9.0), jnp.ones(9))
    )
    bench(resting, physics=heavier)
    assert bench.run.traces == traces
