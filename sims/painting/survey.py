"""A first look at the wall with the base's lidar, before anything is planned."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float, PRNGKeyArray

from jaxpaint.mapping.canvas import Canvas
from jaxpaint.planning import Profile, wall_profile
from sims.robots import Robot
from sims.scenes.scene import Scene
from sims.sensors import Lidar, scan


def survey(
    scene: Scene, canvas: Canvas, robot: Robot, home: tuple[float, float], *, key: PRNGKeyArray
) -> tuple[Profile, Float[np.ndarray, "beams 2"]]:
    """The wall's outline behind the canvas, and all echoes (x, y) in the map frame, NaN where there was none.

    The robot stands before the middle of the canvas, as far as it paints from.
    """
    yaw = float(canvas.yaw)
    ahead, left = np.array([np.cos(yaw), np.sin(yaw)]), np.array([-np.sin(yaw), np.cos(yaw)])
    base = np.asarray(canvas.center, float)[:2] - home[0] * ahead - home[1] * left
    mount = np.asarray(robot.T_base_lidar.p, float)
    place = jnp.asarray([*(base + mount[0] * ahead + mount[1] * left), mount[2]], float)
    lidar = Lidar()
    ranges, valid = jax.jit(lambda p, heading: scan(scene, lidar, p, heading, key=key))(place, canvas.yaw)
    heading = np.asarray(lidar.bearings, float) + yaw
    reach = np.where(np.asarray(valid), np.asarray(ranges, float), np.nan)[:, None]
    echoes = np.asarray(place, float)[:2] + reach * np.stack([np.cos(heading), np.sin(heading)], axis=1)
    return wall_profile(np.asarray(canvas.center, float), yaw, float(canvas.size[0]), echoes), echoes
