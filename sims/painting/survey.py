"""A first look at the place with the base's lidar, and what to look at with the camera after it."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float, PRNGKeyArray

from jaxpaint.kinematics import Pose
from jaxpaint.kinematics.chain import forward
from jaxpaint.kinematics.rotations import exponential
from jaxpaint.localisation import outline_of
from jaxpaint.mapping.canvas import Canvas
from jaxpaint.planning import (
    CameraArm,
    Viewpoints,
    ViewSettings,
    operating_area,
    plan_viewpoints,
    surroundings,
    wall_profile,
)
from sims.odometry import OdometryNoise
from sims.robots import Robot
from sims.scenes.scene import Scene
from sims.sensors import Camera, Lidar, scan
from sims.sight import Sight, drift_of

# Walls and columns that scans are matched with, at most: the longest.
_PIECES = 16


def survey(
    scene: Scene,
    canvas: Canvas,
    robot: Robot,
    camera: Camera,
    settings: ViewSettings | None = None,
    *,
    key: PRNGKeyArray,
) -> tuple[Viewpoints, Float[np.ndarray, "beams 2"]]:
    """The viewpoints for a canvas, and all echoes (x, y) in the map frame, NaN where there was none."""
    arm, s = camera_arm(robot), settings or ViewSettings()
    echoes = echoes_before(scene, canvas, arm, robot, key=key)
    center, yaw = np.asarray(canvas.center, float), float(canvas.yaw)
    width, height = (float(x) for x in canvas.size)
    profile = wall_profile(center, yaw, width, echoes)
    rims = center[2] - height / 2, center[2] + height / 2
    area = operating_area(profile, width, rims, s.margin, s.overlap)
    around = surroundings(echoes, center, yaw, width, float(arm.lidar))
    field = camera.width / float(camera.fx), camera.height / float(camera.fy)
    return plan_viewpoints(area, field, arm, around, s), echoes


def camera_arm(robot: Robot) -> CameraArm:
    """What the planner of views is told of a robot."""
    brush = forward(robot.chain, robot.at_home(jnp.zeros(robot.base_size)))
    return CameraArm(
        chain=robot.camera_chain,
        home=robot.home,
        lower=robot.lower,
        upper=robot.upper,
        brush=brush.p[:2],
        spheres=robot.body_and_brush,
        footprint=robot.footprint,
        lidar=robot.T_base_lidar.p[2],
    )


def echoes_before(
    scene: Scene, canvas: Canvas, arm: CameraArm, robot: Robot, *, key: PRNGKeyArray
) -> Float[np.ndarray, "beams 2"]:
    """What the lidar sees (x, y) in the map frame [m], NaN for nothing.

    The robot stands before the middle of the canvas, as far as it paints from.
    """
    yaw = float(canvas.yaw)
    place = jnp.asarray(lidar_place(canvas, arm, robot), float)
    lidar, heading = Lidar(), canvas.yaw * jnp.asarray([0.0, 0.0, 1.0])
    ranges, valid = jax.jit(lambda p, w: scan(scene, lidar, Pose(p, exponential(w)), key=key))(place, heading)
    bearing = np.asarray(lidar.bearings, float) + yaw
    reach = np.where(np.asarray(valid), np.asarray(ranges, float), np.nan)[:, None]
    return np.asarray(place, float)[:2] + reach * np.stack([np.cos(bearing), np.sin(bearing)], axis=1)


def lidar_place(canvas: Canvas, arm: CameraArm, robot: Robot) -> Float[np.ndarray, "3"]:
    """Where the lidar is as it looks before the job, in the map frame [m]."""
    ahead, left = axes_of(canvas)
    mount = np.asarray(robot.T_base_lidar.p, float)
    return np.array([*(base_before(canvas, arm) + mount[0] * ahead + mount[1] * left), mount[2]])


def base_before(canvas: Canvas, arm: CameraArm) -> Float[np.ndarray, "2"]:
    """Where the base stands before the middle of the canvas, as far as it paints from (x, y) [m]."""
    ahead, left = axes_of(canvas)
    home = np.asarray(arm.brush, float)
    return np.asarray(canvas.center, float)[:2] - home[0] * ahead - home[1] * left


def axes_of(canvas: Canvas) -> tuple[Float[np.ndarray, "2"], Float[np.ndarray, "2"]]:
    """Ahead, to the wall, and left of a base before the canvas, in the map frame."""
    yaw = float(canvas.yaw)
    return np.array([np.cos(yaw), np.sin(yaw)]), np.array([-np.sin(yaw), np.cos(yaw)])


def sight_of(
    canvas: Canvas, robot: Robot, noise: OdometryNoise, echoes: Float[np.ndarray, "beams 2"]
) -> Sight:
    """What the robot looks with, after the survey."""
    place = lidar_place(canvas, camera_arm(robot), robot)
    return Sight(outline_of(echoes, place[:2], count=_PIECES), drift_of(noise, robot.drive))
