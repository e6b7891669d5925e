"""A few pixels of the depth camera: what a controller can afford to look at as it goes."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, PRNGKeyArray

from jaxpaint.kinematics.pose import Pose
from sims.scenes.scene import Scene
from sims.sensors.camera import Camera, rotate
from sims.sensors.depth_noise import DepthNoise


def see_pixels(
    scene: Scene,
    camera: Camera,
    noise: DepthNoise,
    T_map_camera: Pose,
    rays: Float[Array, "n 3"],
    *,
    key: PRNGKeyArray,
) -> tuple[Float[Array, "n"], Bool[Array, "n"]]:
    """Depth along the optical axis [m] of pixels with these rays (camera frame, z = 1), and its validity.

    Disparity noise and quantisation as in `observe`; the pixels must lie further apart than errors are
    correlated. Pixels that see a surface edge-on are lost; edges, dark paint and distortion are not modelled
    here.
    """
    turned = rotate(T_map_camera.R, rays)
    stretch = jnp.sqrt((rays * rays).sum(-1))
    hits = jax.vmap(scene.raycast, in_axes=(None, 0))(T_map_camera.p, turned / stretch[:, None])
    depth = jnp.where(hits.valid, hits.distance, 1.0) / stretch
    incidence = jnp.abs((turned * hits.normal).sum(-1)) / stretch
    valid = hits.valid & (depth >= camera.near) & (depth <= camera.far) & (incidence > jnp.cos(noise.grazing))
    focal = camera.fx * camera.decimation * camera.baseline
    shock = jax.random.normal(key, depth.shape, depth.dtype)
    disparity = focal / depth + noise.disparity_sigma * shock
    coarse = noise.quantum > 0
    step = jnp.where(coarse, noise.quantum, 1.0)
    disparity = jnp.where(coarse, jnp.round(disparity / step) * step, disparity)
    return focal / jnp.maximum(disparity, 1e-3), valid
