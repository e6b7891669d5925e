"""One picture of a depth camera as a cloud."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, PRNGKeyArray

from jaxpaint.kinematics.pose import Pose
from sims.scenes.scene import Scene
from sims.sensors.camera import Camera, pixel_rays, rotate
from sims.sensors.depth_noise import DepthNoise, observe
from sims.sensors.rgbd import RGBD, render


class Scan(eqx.Module):
    """A measured cloud, n = height x width points row by row, all in the map frame.

    points [m]; a pixel without a value has the camera's centre for its point and is not valid. rays: unit
    directions out of the camera. colours: 0 to 1, black where not valid. center: of the camera [m].
    """

    points: Float[Array, "n 3"]
    valid: Bool[Array, "n"]
    rays: Float[Array, "n 3"]
    colours: Float[Array, "n 3"]
    center: Float[Array, "3"]


def take_scan(
    scene: Scene, T_map_camera: Pose, camera: Camera, noise: DepthNoise, *, key: PRNGKeyArray
) -> Scan:
    """What the camera measures of the scene."""
    truth = render(scene, camera, T_map_camera.p, T_map_camera.R)
    return as_scan(observe(truth, camera, noise, key=key), camera, T_map_camera)


def as_scan(picture: RGBD, camera: Camera, T_map_camera: Pose) -> Scan:
    """The cloud of a picture that the camera delivered."""
    along = rotate(T_map_camera.R, pixel_rays(camera).reshape(-1, 3))
    depth = picture.depth.reshape(-1, 1)
    return Scan(
        points=T_map_camera.p + depth * along,
        valid=picture.valid.reshape(-1),
        rays=along / jnp.sqrt((along * along).sum(1, keepdims=True)),
        colours=picture.colour.reshape(-1, 3),
        center=T_map_camera.p,
    )
