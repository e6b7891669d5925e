"""The reference robot's file: S4's table, the maker's limits, a painting posture with room around it."""

import jax.numpy as jnp
import mujoco
import numpy as np
import pytest

from jaxpaint.compiling import batched
from jaxpaint.kinematics import (
    IKSettings,
    Pose,
    forward,
    frame_from_axis,
    jacobian,
    manipulability,
    solve,
    sphere_centers,
)
from sims.robots import load_robot, robot_model

# S4: a, alpha, d of each row.
DH = [
    (0, np.pi / 2, 0.089159),
    (-0.425, 0, 0),
    (-0.39225, 0, 0),
    (0, np.pi / 2, 0.10915),
    (0, -np.pi / 2, 0.09465),
    (0, 0, 0.0823),
]
INTO_WALL = np.array([1.0, 0.0, 0.0])
TO_THE_RIGHT = np.array([0.0, -1.0, 0.0])


@pytest.fixture(scope="module")
def robot():
    return load_robot()


def dh_flange(q):
    """T_flange in the arm's base, from the table as the book has it."""
    T = np.eye(4)
    for angle, (a, alpha, d) in zip(q, DH, strict=True):
        c, s, ca, sa = np.cos(angle), np.sin(angle), np.cos(alpha), np.sin(alpha)
        T = T @ np.array(
            [[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1]]
        )
    return T


def test_the_arm_is_the_table_of_s4(x64):
    robot = load_robot()
    rng = np.random.default_rng(0)
    mount = np.eye(4)
    mount[:3, :3], mount[:3, 3] = np.diag([-1.0, -1.0, 1.0]), [0.15, 0, 0.90]
    for q in rng.uniform(-2 * np.pi, 2 * np.pi, (10, 6)):
        expected = mount @ dh_flange(q) @ [0, 0, 0.15, 1]
        found = forward(robot.arm(jnp.zeros(3)), jnp.asarray(q))
        np.testing.assert_allclose(found.p, expected[:3], atol=1e-12)
        np.testing.assert_allclose(found.R, (mount @ dh_flange(q))[:3, :3], atol=1e-12)


def test_limits_are_the_makers(robot):
    turns = np.array([2, 2, 1, 2, 2, 2]) * np.pi  # the elbow is held to half a turn either way
    np.testing.assert_allclose(robot.upper, turns, rtol=1e-6)
    np.testing.assert_allclose(robot.lower, -turns, rtol=1e-6)
    np.testing.assert_allclose(robot.speed_limit, [0.5, 0.5, 1.0, *[np.pi] * 6], rtol=1e-6)
    np.testing.assert_allclose(robot.acceleration_limit, [0.5, 0.5, 1.0, *[8.0] * 6])


def test_wheels_and_footprint(robot):
    np.testing.assert_allclose(
        robot.drive.position, [[0.28, 0.22], [0.28, -0.22], [-0.28, 0.22], [-0.28, -0.22]]
    )
    assert float(robot.drive.speed_limit) == pytest.approx(12 * 0.10)
    assert float(robot.drive.rate_limit) == pytest.approx(3.0)
    front_left, _, rear_right, _ = robot.footprint
    np.testing.assert_allclose(
        front_left, [0.38, 0.30], atol=0.01
    )  # a wheel's rim lies 5 mm ahead of the chassis
    np.testing.assert_allclose(rear_right, [-0.38, -0.30], atol=0.01)


def test_home_points_the_brush_at_the_wall_with_the_camera_above(robot):
    brush = forward(robot.chain, robot.at_home(jnp.zeros(3)))
    camera = forward(robot.camera_chain, robot.at_home(jnp.zeros(3)))
    np.testing.assert_allclose(brush.p, [0.85, 0, 1.10], atol=1e-5)
    np.testing.assert_allclose(brush.R, frame_from_axis(INTO_WALL, TO_THE_RIGHT), atol=1e-5)
    np.testing.assert_allclose(camera.R, brush.R, atol=1e-5)
    np.testing.assert_allclose(camera.p - brush.p, [-0.125, 0, 0.087], atol=1e-5)


def test_the_camera_does_not_see_the_brush():
    """All of the brush lies outside the camera's opening of 58 degrees, 87 degrees wide."""
    model = robot_model()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    T = data.site("camera")
    for geom in (g for g in range(model.ngeom) if model.geom(g).name.startswith("brush")):
        radius, half = model.geom_size[geom, :2]
        axis = data.geom_xmat[geom].reshape(3, 3)[:, 2]
        for end in (-half, half):
            _, y, z = T.xmat.reshape(3, 3).T @ (data.geom_xpos[geom] + end * axis - T.xpos)
            assert z <= 0 or np.degrees(np.arctan2(y - radius, z)) > 58 / 2 + 2


def test_the_mujoco_camera_looks_where_the_site_says():
    model = robot_model()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    camera, site = data.cam("wrist_camera"), data.site("camera")
    np.testing.assert_allclose(camera.xpos, site.xpos, atol=1e-12)
    # MuJoCo's cameras look along -z with y up
    np.testing.assert_allclose(
        camera.xmat.reshape(3, 3) @ np.diag([1, -1, -1]), site.xmat.reshape(3, 3), atol=1e-12
    )


def test_a_wall_in_front_of_the_shoulder_is_workable(robot):
    """0.6 m to 0.9 m ahead, 0.35 m to either side, 0.8 m to 1.4 m high: reachable, dexterous, clear."""
    arm = robot.arm(jnp.zeros(3))
    R = frame_from_axis(jnp.asarray(INTO_WALL, jnp.float32), jnp.asarray(TO_THE_RIGHT, jnp.float32))
    shoulder = 0.15
    box = [(shoulder + d, y, z) for d in (0.6, 0.9) for y in (-0.35, 0.0, 0.35) for z in (0.8, 1.1, 1.4)]

    def reach(p):
        found = solve(arm, robot.home[None], Pose(p, R), robot.lower, robot.upper, IKSettings(iterations=40))
        centers = sphere_centers(robot.chain, robot.spheres, jnp.concatenate([jnp.zeros(3), found.q]))
        clear = p[0] - (centers[:, 0] + robot.spheres.radius).max()
        return found.converged, manipulability(jacobian(arm, found.q)[1]), clear

    converged, measure, clear = batched(reach, in_axes=(0,), chunk=9)(jnp.asarray(box, jnp.float32))
    assert bool(converged.all())
    assert float(measure.min()) > 0.02
    assert float(clear.min()) > 0.08


def test_velocity_servos_are_stable_and_follow(robot):
    model = robot_model()
    assert model.nu == 17 and model.opt.timestep == pytest.approx(0.02)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    wanted = np.zeros(model.nu)
    wanted[:3], wanted[11:] = [0.1, -0.05, 0.2], 0.1
    data.ctrl[:] = wanted
    for _ in range(100):
        mujoco.mj_step(model, data)
    speeds = np.array([data.joint(model.actuator(i).name).qvel[0] for i in range(model.nu)])
    np.testing.assert_allclose(speeds, wanted, atol=0.01)


def test_the_brush_is_not_part_of_the_body_that_must_stay_clear(robot):
    """At home everything but the brush is at least 0.1 m behind the brush's tip; its spheres 0.09 m."""
    model = robot_model()
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_kinematics(model, data)
    for g in (g for g in range(model.ngeom) if not model.geom(g).name.startswith("brush")):
        R, box = data.geom_xmat[g].reshape(3, 3), model.geom_aabb[g]
        assert (data.geom_xpos[g] + R @ box[:3])[0] + np.abs(R[0]) @ box[3:] < 0.85 - 0.099
    centers = sphere_centers(robot.chain, robot.spheres, robot.at_home(jnp.zeros(3)))
    assert float((centers[:, 0] + robot.spheres.radius).max()) < 0.85 - 0.09
    assert set(np.asarray(robot.spheres.frame).tolist()) == {2, 3, 4, 5, 6, 7, 8}
