"""Worlds that differ, by their keys."""

import dataclasses

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from experiments.commands.paint_options import PaintOptions
from experiments.paint_job import paint_task
from jaxpaint.compiling import PerWorld, without_marks
from sims import randomise
from sims.randomise import Ranges, randomised

INDEX = np.arange(200)


@pytest.fixture(scope="module")
def jobs():
    """A job of every fidelity."""
    kinds = ("kinematic", "dynamic", "wheeled")
    task = paint_task(PaintOptions(fidelity="wheeled"))
    other = {kind: paint_task(PaintOptions(fidelity=kind)).job.fidelity for kind in kinds[:2]}
    return {
        kind: dataclasses.replace(task.job, fidelity=other.get(kind, task.job.fidelity)) for kind in kinds
    }


def drawn(job):
    return without_marks(job).tree


def test_every_draw_is_within_its_range_and_fills_it(jobs):
    ranges = Ranges()
    job, plain = drawn(randomised(jobs["wheeled"], ranges, INDEX)), jobs["wheeled"]
    physics, nominal = job.fidelity.fidelity.physics, plain.fidelity.physics
    shares = {
        "mass": (physics.mass / nominal.mass - 1, 0.05),
        "gain": (physics.velocity_gain / nominal.velocity_gain - 1, 0.2),
        "joints": (job.calibration.joints, 5e-4),
        "camera": (job.calibration.camera_position, 1e-3),
        "turned": (job.calibration.camera_rotation, 5e-3),
        "depth": (job.noise.depth.disparity_sigma / plain.noise.depth.disparity_sigma - 1, 0.3),
        "lidar": (job.sight.scanner.sigma / plain.sight.scanner.sigma - 1, 0.3),
    }
    for name, (found, most) in shares.items():
        found = np.asarray(found)
        assert np.abs(found).max() <= most * 1.001, name
        assert found.min() < -0.9 * most and found.max() > 0.9 * most, name
    assert 0.5 <= physics.friction.min() < 0.55 and 0.95 < physics.friction.max() <= 1.0
    for name in ("mass", "gravity"):  # what the arm balances is what it should weigh
        np.testing.assert_array_equal(getattr(job.fidelity.fidelity.known, name), getattr(nominal, name))
    assert job.fidelity.latency.min() >= 0 and 0.018 < job.fidelity.latency.max() <= 0.02
    gravity = np.asarray(physics.gravity)
    np.testing.assert_allclose(np.linalg.norm(gravity, axis=1), 9.81, rtol=1e-6)
    slope = np.arccos(-gravity[:, 2] / 9.81)
    assert np.linalg.norm(gravity[:, :2], axis=1).max() / 9.81 <= 5e-3 * 1.001 and slope.max() < 6e-3


@pytest.mark.parametrize("kind", ["kinematic", "dynamic", "wheeled"])
def test_only_what_changes_is_kept_for_each_world(jobs, kind):
    job = randomised(jobs[kind], Ranges(), INDEX)
    marked = [
        x for x in jax.tree.leaves(job, is_leaf=lambda x: isinstance(x, PerWorld)) if isinstance(x, PerWorld)
    ]
    assert len(marked) == {"kinematic": 4, "dynamic": 8, "wheeled": 9}[kind]
    assert all(np.shape(y)[0] == len(INDEX) for x in marked for y in jax.tree.leaves(x.value))
    assert all(np.size(y) <= 30 * len(INDEX) for x in marked for y in jax.tree.leaves(x.value))


def test_a_world_is_the_same_among_others(jobs):
    many = drawn(randomised(jobs["dynamic"], Ranges(), INDEX))
    few = drawn(randomised(jobs["dynamic"], Ranges(), np.array([7, 3])))
    for a, b in zip(jax.tree.leaves(many.calibration), jax.tree.leaves(few.calibration), strict=True):
        np.testing.assert_array_equal(np.asarray(a)[[7, 3]], b)
    np.testing.assert_array_equal(
        many.fidelity.fidelity.physics.mass[7], few.fidelity.fidelity.physics.mass[0]
    )


def test_other_ranges_compile_nothing(jobs):
    randomised(jobs["dynamic"], Ranges(), INDEX)
    before = randomise._DRAW.traces
    found = drawn(randomised(jobs["dynamic"], Ranges(mass=0.5, latency=0.1), INDEX))
    assert randomise._DRAW.traces == before
    assert 0.05 < np.abs(found.fidelity.latency).max() <= 0.1


def test_ranges_of_nothing_change_nothing(jobs):
    job = drawn(randomised(jobs["wheeled"], Ranges().scaled(0.0, 0.8), INDEX[:2]))
    plain = jobs["wheeled"].fidelity.physics
    for name in ("mass", "velocity_gain", "position_gain", "gravity", "friction"):
        found = np.asarray(getattr(job.fidelity.fidelity.physics, name))
        np.testing.assert_allclose(found, np.broadcast_to(getattr(plain, name), found.shape), rtol=1e-6)
    assert not np.asarray(job.calibration.joints).any() and not np.asarray(job.fidelity.latency).any()


def test_calibration_moves_the_true_brush_alone(jobs):
    from sims.truth import Calibration, true_brush, true_camera

    robot = jobs["kinematic"].robot
    base, level = jnp.asarray([0.3, -0.2, 0.4]), jnp.zeros(3)
    right = true_brush(robot.chain, Calibration(), base, level, robot.home).p
    wrong = true_brush(robot.chain, Calibration(joints=1e-3), base, level, robot.home).p
    np.testing.assert_allclose(
        wrong, true_brush(robot.chain, Calibration(), base, level, robot.home + 1e-3).p, atol=1e-6
    )
    assert 1e-4 < float(jnp.linalg.norm(wrong - right)) < 3e-3
    moved = true_camera(
        robot, Calibration(camera_position=jnp.asarray([0.0, 0.0, 0.01])), base, level, robot.home
    )
    camera = true_camera(robot, Calibration(), base, level, robot.home)
    np.testing.assert_allclose(moved.p - camera.p, 0.01 * camera.R[:, 2], atol=1e-6)


def test_a_tilt_turns_about_the_foot():
    from sims.truth import tilt_rotation

    tilt, yaw = jnp.asarray([0.0, 0.02, -0.03]), jnp.asarray(0.7)
    c, s = np.cos(0.7), np.sin(0.7)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    roll = np.array([[1, 0, 0], [0, np.cos(0.02), -np.sin(0.02)], [0, np.sin(0.02), np.cos(0.02)]])
    pitch = np.array([[np.cos(0.03), 0, -np.sin(0.03)], [0, 1, 0], [np.sin(0.03), 0, np.cos(0.03)]])
    np.testing.assert_allclose(tilt_rotation(yaw, tilt) @ turn, turn @ pitch @ roll, atol=1e-6)
    assert eqx.tree_equal(
        tilt_rotation(yaw, 0 * tilt) @ turn, jnp.asarray(turn, jnp.float32), rtol=1e-6, atol=1e-6
    )
