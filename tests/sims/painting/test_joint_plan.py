"""A run as one joint trajectory: consistent, within what the robot can do, and painting what was planned."""

import jax
import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.spatial import cKDTree

from experiments.exports import read_table, write_table
from experiments.exports.planned import planned
from experiments.exports.replay import replay
from experiments.motion.truth import Truth
from sims.painting.joint_plan import eased, planned_joint_trajectory, smooth_trajectory
from sims.status import Status


def test_velocity_and_acceleration_are_those_of_the_positions():
    time = np.cumsum([0.0, 0.02, 0.02, 0.02, 0.03, 0.04, 0.04, 0.03, 0.02, 0.02])
    shape = np.sin(np.pi * time / time[-1]) ** 2
    found = smooth_trajectory(("a", "b"), ("m", "rad"), time, np.stack([shape, -shape], 1), time > 0.1)
    p, v, a, h = found.position, found.velocity, found.acceleration, np.diff(time)[:, None]
    # A jerk that is constant between samples takes each into the next.
    np.testing.assert_allclose(p[1:], p[:-1] + v[:-1] * h + (2 * a[:-1] + a[1:]) * h**2 / 6, atol=1e-12)
    np.testing.assert_allclose(v[1:], v[:-1] + (a[:-1] + a[1:]) * h / 2, atol=1e-12)
    np.testing.assert_array_equal(p[:, 0], shape)
    np.testing.assert_allclose(v[[0, -1]], 0, atol=1e-12)
    slope = np.pi / time[-1] * np.sin(2 * np.pi * time / time[-1])
    np.testing.assert_allclose(v[:, 0], slope, atol=0.02 * slope.max())


def test_an_angle_does_not_jump_by_a_turn():
    time = np.linspace(0, 2, 101)
    turning = 3 + time
    wrapped = (turning + np.pi) % (2 * np.pi) - np.pi
    found = smooth_trajectory(("yaw", "x"), ("rad", "m"), time, np.stack([wrapped, wrapped], 1), time > 1)
    np.testing.assert_allclose(found.position[:, 0], turning)
    assert np.abs(found.velocity[:, 0]).max() < 2
    assert np.abs(found.velocity[:, 1]).max() > 50, "a slide is taken at its word"


@pytest.fixture(scope="module")
def plan(task, mission):
    return planned_joint_trajectory(task.job, mission, 1)


def test_the_trajectory_is_whole_and_smooth(task, plan):
    assert plan.names == task.job.robot.chain.names
    assert plan.units[:4] == ("m", "m", "rad", "rad")
    assert plan.time[0] == 0
    assert (np.diff(plan.time) > 0).all()
    assert np.diff(plan.time).max() < 0.1
    assert not plan.pen[[0, -1]].any()
    np.testing.assert_allclose(plan.velocity[[0, -1]], 0, atol=1e-9)
    # No step between the parts: what changes between samples is what the velocities say.
    change = np.diff(plan.position, axis=0)
    mean = (plan.velocity[1:] + plan.velocity[:-1]) / 2 * np.diff(plan.time)[:, None]
    assert np.abs(change - mean).max() < 5e-3


def test_the_trajectory_is_within_what_the_robot_can_do_between_samples_too(task, plan):
    """Speed, acceleration and, by MuJoCo's inverse dynamics, torque."""
    spline = CubicSpline(plan.time, plan.position, bc_type="clamped")
    share = np.linspace(0, 1, 4, endpoint=False)
    fine = np.append((plan.time[:-1, None] + share * np.diff(plan.time)[:, None]).ravel(), plan.time[-1])
    p, v, a = (spline(fine, order) for order in range(3))
    np.testing.assert_allclose(a[::4], plan.acceleration, atol=1e-9)
    robot = task.job.robot
    torque = Truth(task.job.scene, robot).torques(p, v, a)
    for found, limit in ((v, robot.speed_limit), (a, robot.acceleration_limit), (torque, robot.torque_limit)):
        assert (np.abs(found).max(axis=0) <= 1.001 * np.asarray(limit)).all()
    assert (np.abs(torque[:, 3:6]).max(axis=0) > 1).all(), "it carries its own weight"


def test_what_starts_at_once_is_eased_into():
    """From rest to 0.5 m/s^2 from one sample to the next, and back."""
    h, pushes = 0.08, np.repeat([0.0, 0.5, 0.0, -0.5, 0.0], 13)
    time = h * np.arange(len(pushes) + 2)
    way = h**2 * np.concatenate([[0, 0], np.cumsum(np.cumsum(pushes))])[:, None]
    free, soft = (smooth_trajectory(("x",), ("m",), time, p, time > 1) for p in (way, eased(time, way)))
    assert np.abs(free.acceleration).max() > 0.6
    np.testing.assert_allclose(soft.acceleration[1:-1, 0], pushes, atol=1e-9)
    assert np.abs(soft.position - way).max() <= h**2 / 6 * 0.5 + 1e-12


def test_replayed_by_servos_from_the_table_the_brush_stays_on_the_plan(mission, plan, tmp_path):
    write_table(plan, tmp_path / "trajectory.csv")
    found = replay(read_table(tmp_path / "trajectory.csv"))
    assert found.error.max() < 1e-3
    rows = mission.painting.plan.rows[1]
    path = rows[rows[:, 18] > 0.5][:, :3]
    off, _ = cKDTree(path).query(found.reached[found.pen])
    assert off.max() < 3e-3, "the brush against the path that the controller was given"
    missed, _ = cKDTree(found.reached[found.pen]).query(path)
    assert missed.max() < 5e-3, "all of the path is painted"


def test_a_world_that_broke_has_no_trajectory(task, mission):
    rows = mission.painting.plan.rows.copy()
    rows[2] = np.nan
    broken = mission._replace(
        painting=mission.painting._replace(plan=mission.painting.plan._replace(rows=rows))
    )
    with pytest.raises(ValueError, match="world 2"):
        planned_joint_trajectory(task.job, broken, 2)


def test_a_world_of_a_later_group_is_found_and_a_lost_one_is_not_exported(task, mission, plan):
    later, index = _part(mission, slice(1, 4)), np.arange(1, 4)
    found, why = planned(task.job, index, later, 1)
    assert why == ""
    assert found is not None
    np.testing.assert_array_equal(found.position, plan.position)
    lost = later._replace(status=np.array([Status.OK, Status.UNREACHABLE, Status.OK]))
    none, why = planned(task.job, index, lost, 2)
    assert none is None
    assert "world 2 is unreachable" in why


def _part(mission, rows):
    painting = jax.tree.map(lambda x: np.asarray(x)[rows], mission.painting)
    return mission._replace(status=mission.status[rows], painting=painting)
