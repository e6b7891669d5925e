"""Motion through waypoints: straight where it can be, around where the wall is in the way."""

from types import SimpleNamespace
from typing import cast

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint import planning
from jaxpaint.kinematics import forward
from jaxpaint.mapping import Canvas
from jaxpaint.trajectories import sample
from sims.painting.job import Job
from sims.painting.motion import SETTLE, clear_motion, find_ways, motion_duration, motion_rows
from sims.painting.segments import Around, filled, in_blocks, plan_segments, surroundings
from sims.painting.survey import camera_arm, echoes_before
from sims.robots import load_robot
from sims.scenes.canvases import canvas_for
from sims.scenes.walls import make_wall


@pytest.fixture(scope="module")
def job():
    """What planning needs of one: the reference robot before a flat wall at x = 0, as its lidar saw it."""
    canvas = Canvas(*map(jnp.asarray, ([0.0, 0.0, 1.2], 0.0, [1.2, 0.8])))
    echoes = jnp.stack([jnp.zeros(541), jnp.linspace(-4.0, 4.0, 541)], axis=-1)
    return cast(Job, SimpleNamespace(robot=load_robot(), canvas=canvas, echoes=echoes, dt=jnp.asarray(0.02)))


@pytest.fixture(scope="module")
def waypoints(job):
    """In the first world free in the room; in the second to a posture that a panel stands before."""
    home = np.asarray(job.robot.at_home(jnp.array([-1.6, 0.0, 0.0])))
    rows = np.stack([home] * 3)
    rows[1, 3] += 0.4
    rows[2, :3] = [-1.6, 0.4, 0.2]
    behind = rows.copy()
    behind[1] = home
    behind[2] = home
    behind[2, :2] = [-1.6, 1.4]
    return np.stack([rows, behind]).astype(np.float32)


@pytest.fixture(scope="module")
def panel():
    """A board that stands out of the wall between the ends of the second world's way."""
    x, z = np.meshgrid(np.arange(-0.95, 0.0, 0.03), np.arange(0.6, 2.0, 0.03))
    return np.stack([x.ravel(), 0 * x.ravel() + 0.7, z.ravel()], -1)


@pytest.fixture(scope="module")
def motion(job, waypoints, panel):
    nothing = np.full_like(panel, np.nan)
    return clear_motion(job, jnp.asarray(waypoints), jnp.asarray(np.stack([nothing, panel]), jnp.float32))


ROWS = 2000
SAMPLE, SAMPLES = jax.jit(sample), jax.jit(lambda t, dt: motion_rows(t, dt, ROWS))


def test_it_rests_at_the_waypoints_in_both_worlds(job, waypoints, motion):
    for world in range(2):
        one = jax.tree.map(lambda x, w=world: jnp.asarray(x)[w], motion.trajectory)
        for k, arrival in enumerate(np.asarray(motion.arrival)[world]):
            state = SAMPLE(one, jnp.asarray(arrival + SETTLE / 2))
            np.testing.assert_allclose(state.p, waypoints[world, k], atol=1e-4)
            np.testing.assert_allclose(state.v, 0, atol=1e-6)
        assert float(motion_duration(one)) < ROWS * float(job.dt)
        rows = np.asarray(SAMPLES(one, job.dt))
        np.testing.assert_allclose(rows[-1, :9], waypoints[world, -1], atol=1e-4)
        step = np.diff(rows[:, :9], axis=0) / float(job.dt)
        np.testing.assert_allclose(step, (rows[1:, 9:] + rows[:-1, 9:]) / 2, atol=0.02)


def test_only_the_way_that_is_barred_is_bent(motion):
    segments = np.asarray(motion.trajectory.segments).reshape(2, 2, 3) > 0
    # a segment's way to its first via point, to its second, and from there
    assert not segments[0, :, :2].any() and segments[0, :, 2].all()
    assert segments[1, 1].all()
    assert (np.asarray(motion.gap) > 0.02).all()


def test_a_goal_inside_a_board_is_known_to_touch(job, waypoints, panel):
    """Its gap is below zero whatever the way, which makes a mission unreachable."""
    inside = waypoints[1, [0, 2]].copy()
    inside[1, :2] = [-0.9, 0.7]
    found = find_ways(Around.of(job), inside[None], panel[None].astype(np.float32))
    assert found.gap.min() < 0
    np.testing.assert_allclose(found.ends[0, [0, -1], [0, 1]], inside, atol=1e-6)
    np.testing.assert_allclose(found.ends[0, 1:, 0], found.ends[0, :-1, 1], atol=1e-6)


def test_the_chassis_is_seen_between_the_points_that_stand_for_it(job):
    """A thin post in its front, as scanned points from the floor up. By the base's rectangle alone the gap is
    exact; its spheres stick out a little.
    """
    q = np.asarray(job.robot.at_home(jnp.array([-2.0, 0.0, 0.0])))
    front = float(job.robot.footprint[:, 0].max())
    heights = np.arange(0.0, 0.4, 0.02)
    post = np.stack([0 * heights - 2.0 + front - 0.05, 0 * heights + 0.1, heights], -1)
    around = Around.of(job)
    bare = eqx.tree_at(lambda a: a.robot.spheres.radius, around, around.robot.spheres.radius - 10)
    gaps = [
        find_ways(a, np.stack([q, q])[None], post[None].astype(np.float32)).at_ends[0, -1].min()
        for a in (bare, around)
    ]
    assert gaps[0] == pytest.approx(-0.05, abs=1e-3)
    assert gaps[0] - 0.01 < gaps[1] <= gaps[0]


@pytest.mark.parametrize(("kind", "enclosed"), [("corner", True), ("objects", False), ("room", True)])
def test_what_is_low_for_the_view_planner_is_low_for_the_arm(job, kind, enclosed):
    """And nothing else: a room's side walls and column stand at all heights."""
    scene = make_wall(kind)
    canvas, robot = canvas_for(scene), job.robot
    echoes = echoes_before(scene, canvas, camera_arm(robot), robot, key=jax.random.key(3))
    lidar = float(robot.T_base_lidar.p[2])
    told = planning.surroundings(
        echoes, np.asarray(canvas.center, float), float(canvas.yaw), float(canvas.size[0]), lidar
    )
    there = surroundings(Around(robot, canvas, jnp.asarray(echoes, jnp.float32)), jnp.full((1, 3), jnp.nan))
    real, low = np.asarray(there.real), np.asarray(there.high) < 2
    np.testing.assert_allclose(there.place[real & low], told.clutter, atol=1e-5)
    np.testing.assert_allclose(there.place[real & ~low], told.walls, atol=1e-5)
    np.testing.assert_allclose(there.high[real & low], told.top, atol=1e-5)
    beside = np.abs(told.walls[:, 1] - float(canvas.center[1])) > float(canvas.size[0]) / 2 + 0.5
    assert (beside & (told.walls[:, 0] < float(canvas.center[0]) - 0.5)).any() == enclosed


def test_over_what_the_camera_saw_beyond_nothing_stands(job):
    """A wall's echo stands at all heights until the camera has seen a wall behind it."""
    canvas = canvas_for(make_wall("flat"))
    x, y = np.asarray(canvas.center[:2])
    around = Around(job.robot, canvas, jnp.array([[x, y], [x + 0.2, y + 0.5]]))
    seen = jnp.array([[x + 0.2, y + 0.01, 0.8], [x + 0.2, y + 0.5, 0.75]])
    high = np.asarray(surroundings(around, seen).high)
    np.testing.assert_allclose(high[-2:], [0.8, 1e3])


def test_blocks_give_back_as_many_rows_as_came():
    taken = []

    def program(scale, rows):
        taken.append(len(rows))
        return scale * rows

    rows = np.arange(70.0)
    np.testing.assert_allclose(in_blocks(program, (2.0,), (rows,)), 2 * rows)
    assert len(set(taken)) == 1
    more = filled(np.zeros((2, 5, 3)))
    assert more.shape[1] % 64 == 0 and np.isfinite(more).all(-1).sum() == 10


def test_no_join_jumps_in_position_speed_or_acceleration(motion):
    """At start, waypoints, via points and end of both worlds, in double precision: there nothing moves or
    accelerates, and a tenth of a millisecond aside hardly so.
    """
    around, still = np.array([-1e-4, 0, 1e-4]), 8.0 / 0.04 * 1e-4 * 1.1  # [rad/s^2]: the steepest build-up
    with jax.enable_x64(True):
        for world in range(2):
            one = jax.tree.map(lambda x, w=world: jnp.asarray(np.asarray(x, float)[w]), motion.trajectory)
            begin = np.asarray(one.start)
            joins = np.unique(np.concatenate([begin, begin + np.asarray(one.segments), [0, one.duration]]))
            states = [
                jax.vmap(lambda t, one=one: sample(one, t))(jnp.asarray(join + around)) for join in joins
            ]
            for state in states:
                assert np.abs(state.a).max() < still and np.abs(state.v).max() < still * 1e-4
                assert np.abs(np.diff(state.p, axis=0)).max() < 1e-7


def test_a_motor_that_cannot_hold_the_arm_is_told(job):
    """The arm weighs about 60 N m at the shoulder."""
    ends = np.asarray(job.robot.at_home(jnp.array([-3.0, 0, 0])), np.float32)[None, None].repeat(2, axis=1)
    ends[0, 1, 0] += 0.3
    nothing = np.full((1, 1, 3), np.nan, np.float32)
    weak = eqx.tree_at(lambda a: a.robot.torque_limit, Around.of(job), job.robot.torque_limit.at[4].set(10.0))
    assert find_ways(Around.of(job), ends, nothing).strong.all()
    assert not find_ways(weak, ends, nothing).strong.all()


def test_the_brush_counts_but_on_a_way_to_its_touch(job):
    """A thing at the brush, two centimetres from its tip: no goal, but a run may begin there."""
    home = np.asarray(job.robot.at_home(jnp.array([-3.0, 0, 0])), np.float32)
    pose = forward(job.robot.chain, jnp.asarray(home))
    post = np.asarray(pose.p - 0.02 * pose.R[:, 2], np.float32)[None, None]
    ends = np.stack([home - 0.2 * (np.arange(9) == 0), home]).astype(np.float32)[None]
    assert find_ways(Around.of(job), ends, post).gap.min() < 0
    assert find_ways(Around.of(job), ends, post, np.array([[False, True]])).gap.min() > 0
    assert 0 < find_ways(Around.of(job), ends[:, ::-1], post).gap.min() < 0.011


def test_a_tool_that_would_pass_through_the_forearm_goes_another_way_or_is_known_to(job):
    """Joint by joint the straight way is short; the tool is in the forearm in the middle of it."""
    ends = np.array(
        [[-3, 0, 0, -0.24, -0.96, 1.96, 2.14, -1.34, 0], [-3, 0, 0, 0.86, -2.69, 1.65, 1.12, -4.40, -3.39]]
    )
    nothing = np.full((1, 1, 3), np.nan, np.float32)
    straight = plan_segments(Around.of(job), ends[None].astype(np.float32), nothing, np.zeros((1, 2), bool))
    assert straight.at_ends.min() > 0 and straight.gap[0] < -0.03
