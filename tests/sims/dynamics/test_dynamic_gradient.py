"""Gradients through dynamic control steps: reverse mode against central differences in float64."""

import copy

import equinox as eqx
import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest

from jaxpaint.compiling import batched
from jaxpaint.decisions import default_thresholds
from jaxpaint.kinematics import forward
from opt.controller import Command
from opt.plan import Samples
from opt.wbc import WholeBodyController, default_settings
from sims.dynamics import Engine, dynamic, physics_of, planar_model
from sims.limits import robot_limits
from sims.noise import noise_preset
from sims.odometry import Slip, no_slip
from sims.robots import load_robot, robot_model
from sims.rollout import run_block, start
from sims.worlds import standing

DT = 0.02
# Physics steps in a control step; the product uses twice as many, and one test does.
SUBSTEPS = 2
# Logarithms of scales: position gain, arm effort, base effort, pace, mass of all links, servo gain; then the
# arm at the start [rad].
PARAMETERS = 12


def doubles(tree):
    def double(x):
        floating = eqx.is_array(x) and jnp.issubdtype(x.dtype, jnp.floating)
        return jnp.asarray(x, jnp.float64) if floating else x

    return jax.tree.map(double, tree)


def line(brush, steps):
    """Rows of the reference: along the wall at 30 mm/s."""
    time = np.arange(steps) * DT
    position = np.asarray(brush.p) + np.stack([0 * time, 0.03 * time, 0.01 * time], axis=1)
    velocity = np.tile([0.0, 0.03, 0.01], (steps, 1))
    rotation = np.tile(np.asarray(brush.R).reshape(-1), (steps, 1))
    return np.concatenate([position, rotation, velocity, np.zeros((steps, 3)), np.ones((steps, 1))], axis=1)


class Problem:
    """Mean squared distance of the brush from a line [mm^2], of parameters in float64."""

    def __init__(self, records, substeps):
        robot = load_robot()
        self.limits = doubles(robot_limits(robot))
        self.noise = doubles(noise_preset("s1-simulation").odometry)
        self.fidelity = doubles(dynamic(robot_model(), substeps=substeps))
        self.home, self.records = doubles(robot.home), records
        brush = forward(self.limits.chain, jnp.concatenate([jnp.zeros(3), self.home]))
        self.rows = jnp.asarray(line(brush, 4 * records + 2))

    def follow(self, scale):
        settings = doubles(default_settings())
        settings = eqx.tree_at(
            lambda s: (s.position_gain, s.arm_effort, s.base_effort, s.qp_smoothing),
            settings,
            (
                settings.position_gain * scale[0],
                settings.arm_effort * scale[1],
                settings.base_effort * scale[2],
                jnp.asarray(1e-4),
            ),
        )
        thresholds = doubles(
            default_thresholds(release_margin=0.0, halt_temperature=0.05, release_temperature=0.05)
        )
        step, far = jnp.asarray(DT), jnp.asarray([[0.0, 0.3, 0.0]])
        reference, stations = Samples(self.rows, step, 0 * step), Samples(far, step, 0 * step)
        speed, duration = jnp.asarray(0.03), jnp.asarray(10.0)
        return WholeBodyController(
            self.limits, settings, thresholds, reference, stations, speed, scale[3], duration
        )

    def loss(self, parameters):
        scale, one = jnp.exp(parameters[:6]), jnp.ones(4)
        follow = self.follow(scale)
        fidelity = eqx.tree_at(
            lambda f: (f.physics.mass, f.physics.velocity_gain),
            self.fidelity,
            (self.fidelity.physics.mass * scale[4], self.fidelity.physics.velocity_gain * scale[5]),
        )
        world = standing(
            jnp.zeros(3), self.home + parameters[6:], Slip(0.01 * jnp.asarray([1, -1, 2, 0.5]), 0.01 * one), 4
        )
        state, _ = run_block(
            follow,
            fidelity,
            self.limits,
            self.noise,
            jnp.asarray(DT),
            start(follow, fidelity, world),
            jax.random.key(0),
            records=self.records,
        )
        brush = forward(self.limits.chain, jnp.concatenate([state.world.base, state.world.arm])).p
        return 1e6 * ((brush - self.rows[4 * self.records, :3]) ** 2).sum()


def largest_difference(records, points, substeps=SUBSTEPS):
    """Relative, between reverse mode and central differences, over random points."""
    problem = Problem(records, substeps)
    rng = np.random.default_rng(3)
    at = rng.uniform(-0.3, 0.3, (points, PARAMETERS)) * np.array([1.0] * 6 + [0.03] * 6)
    both = batched(lambda p: jax.value_and_grad(problem.loss)(p), in_axes=(0,), chunk=points)
    value, gradient = both(jnp.asarray(at))
    assert np.isfinite(value).all() and np.isfinite(gradient).all()
    h = 1e-6
    shifts = h * np.concatenate([np.eye(PARAMETERS), -np.eye(PARAMETERS)])
    once = batched(problem.loss, in_axes=(0,), chunk=2 * PARAMETERS)
    moved = (at[:, None] + shifts).reshape(-1, PARAMETERS)
    values = np.asarray(once(jnp.asarray(moved))).reshape(points, 2 * PARAMETERS)
    difference = (values[:, :PARAMETERS] - values[:, PARAMETERS:]) / (2 * h)
    gradient = np.asarray(gradient)
    parts = [slice(0, 4), slice(4, 6), slice(6, 12)]  # controller, physics, state
    off = [
        np.linalg.norm(difference[:, p] - gradient[:, p], axis=1) / np.linalg.norm(difference[:, p], axis=1)
        for p in parts
    ]
    return np.max(off), (both.compile_s, once.compile_s)


@pytest.mark.slow
def test_through_twenty_control_steps(x64):
    off, seconds = largest_difference(records=5, points=8)
    print(f"relative difference {off:.1e}, compiled in {seconds} s")
    assert off <= 1e-3


@pytest.mark.slow
def test_through_four_control_steps(x64):
    off, _ = largest_difference(records=1, points=2)
    assert off <= 1e-3


@pytest.mark.slow
def test_with_the_physics_steps_of_the_product(x64):
    off, _ = largest_difference(records=1, points=1, substeps=4)
    assert off <= 1e-3


SMALL = """<mujoco><worldbody><body>
<joint name="base_x" type="slide" axis="1 0 0"/><joint name="base_y" type="slide" axis="0 1 0"/>
<joint name="base_yaw"/><geom type="box" size="0.3 0.2 0.1" mass="40"/>
<body pos="0.1 0 0.5"><joint name="one" axis="0 1 0"/>
<geom type="box" size="0.3 0.05 0.06" pos="0.3 0 0" mass="4"/>
<body pos="0.6 0 0"><joint name="two" axis="0.1 1 0.2"/>
<geom type="box" size="0.2 0.05 0.03" pos="0.2 0 0" mass="2"/>
<site name="brush"/></body></body></body></worldbody>
<actuator><velocity joint="one" kv="300" forcerange="-60 60"/>
<velocity joint="two" kv="80" forcerange="-6 6"/></actuator>
</mujoco>"""


def stepped_in_c(planar, physics, p):
    """Joints and speeds after one step of MuJoCo in C. p: as in the test below."""
    model, still = copy.copy(planar), mujoco.MjData(planar)
    model.opt.timestep = 0.005
    model.body_mass[1:] *= np.exp(p[15])
    model.actuator_biasprm[:, 2] *= np.exp(p[16])
    model.actuator_biasprm[3:, 1] = -np.asarray(physics.position_gain)
    still.qpos[:] = p[:5]
    mujoco.mj_forward(model, still)
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:] = p[:5], p[5:10]
    data.ctrl[:] = 100 * p[10:15] + (1 - float(physics.gravity_error)) * still.qfrc_bias
    mujoco.mj_step(model, data)
    return np.concatenate([data.qpos, data.qvel])


def test_of_one_physics_step(x64):
    """Against differences of MuJoCo in C; one motor is at its limit, and follows nothing."""
    planar = planar_model(mujoco.MjModel.from_xml_string(SMALL))
    engine, physics = Engine(planar), doubles(physics_of(planar))
    weights = np.random.default_rng(1).normal(size=10)

    def moved(p):
        """p: joints [5], speeds [5], what servos are told [5, 100 N m], logarithms of mass and gain."""
        some = eqx.tree_at(
            lambda f: (f.mass, f.velocity_gain),
            physics,
            (physics.mass * jnp.exp(p[15]), physics.velocity_gain * jnp.exp(p[16])),
        )
        model = engine.with_physics(some, jnp.asarray(0.005))
        after = engine.advance(model, p[:5], p[5:10], 100 * p[10:15], 1 - some.gravity_error)
        return (weights * jnp.concatenate(after)).sum()

    at = np.random.default_rng(0).uniform(-0.1, 0.1, 17)
    at[14] = 1.0  # the weight of the last link is 4 N m, its motor's limit 6 N m
    run = batched(lambda p: jax.value_and_grad(moved)(p), in_axes=(0,), chunk=1)
    value, gradient = (np.asarray(x)[0] for x in run(at[None]))
    np.testing.assert_allclose(value, weights @ stepped_in_c(planar, physics, at), rtol=1e-9)
    steps = 1e-5 * np.eye(17)
    ends = [[weights @ stepped_in_c(planar, physics, at + s * h) for h in steps] for s in (1, -1)]
    difference = (np.array(ends[0]) - np.array(ends[1])) / 2e-5
    assert gradient[14] == 0
    np.testing.assert_allclose(gradient, difference, rtol=1e-6, atol=1e-8)


@pytest.mark.slow
def test_of_the_physics_alone(x64):
    """Three control steps under one command: the gradient by speeds, mass, gain and start."""
    robot = load_robot()
    limits, noise = doubles(robot_limits(robot)), doubles(noise_preset("none").odometry)
    fidelity, home = doubles(dynamic(robot_model(), substeps=1)), doubles(robot.home)

    def reach(p):
        """p: joint speeds [6], logarithms of mass and servo gain, arm at the start [6]."""
        moved = eqx.tree_at(
            lambda f: (f.physics.mass, f.physics.velocity_gain),
            fidelity,
            (
                fidelity.physics.mass * jnp.exp(p[6]),
                fidelity.physics.velocity_gain * jnp.exp(p[7]),
            ),
        )
        world = moved.begin(standing(jnp.zeros(3), home + p[8:], no_slip(4), 4))
        still = jnp.zeros(3)

        def step(world, _):
            command = Command(still, still, p[:6])
            return moved.step(limits, noise, world, command, still, jnp.asarray(DT)), None

        world, _ = jax.lax.scan(step, world, length=3)
        q = jnp.concatenate([world.base, world.arm])
        return 1e3 * forward(limits.chain, q).p.sum() + world.arm_velocity.sum()

    at = np.random.default_rng(0).uniform(-0.1, 0.1, (1, 14))
    gradient = np.asarray(batched(lambda p: jax.grad(reach)(p), in_axes=(0,), chunk=2)(at))[0]
    shifts = 1e-6 * np.concatenate([np.eye(14), -np.eye(14)])
    values = np.asarray(batched(reach, in_axes=(0,), chunk=28)(at + shifts))
    difference = (values[:14] - values[14:]) / 2e-6
    for part in (slice(0, 6), slice(6, 8), slice(8, 14)):
        off = np.linalg.norm(difference[part] - gradient[part])
        assert off <= 1e-3 * np.linalg.norm(difference[part])
