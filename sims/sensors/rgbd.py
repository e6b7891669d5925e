"""A noiseless depth and colour image of a scene."""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from sims.scenes.scene import Scene
from sims.sensors.camera import Camera, pixel_rays, rotate


class RGBD(eqx.Module):
    """One picture: depth along the optical axis [m] (0 where invalid), colour 0 to 1, cosine of incidence."""

    depth: Float[Array, "height width"]
    colour: Float[Array, "height width 3"]
    incidence: Float[Array, "height width"]
    valid: Bool[Array, "height width"]


def render(
    scene: Scene, camera: Camera, p_map_camera: Float[Array, "3"], R_map_camera: Float[Array, "3 3"]
) -> RGBD:
    """What the camera would see without noise.

    A pixel is invalid where its ray meets nothing, or nothing between `camera.near` and `camera.far`.
    """
    rays = rotate(R_map_camera, pixel_rays(camera)).reshape(-1, 3)
    stretch = jnp.sqrt((rays * rays).sum(-1))
    directions = rays / stretch[:, None]
    hits = jax.vmap(scene.raycast, in_axes=(None, 0))(p_map_camera, directions)
    depth = hits.distance / stretch
    valid = hits.valid & (depth >= camera.near) & (depth <= camera.far)
    shape = camera.height, camera.width
    return RGBD(
        depth=jnp.where(valid, depth, 0).reshape(shape),
        colour=jnp.where(valid[:, None], hits.colour, 0).reshape(*shape, 3),
        incidence=jnp.where(valid, jnp.abs((directions * hits.normal).sum(-1)), 0).reshape(shape),
        valid=valid.reshape(shape),
    )
