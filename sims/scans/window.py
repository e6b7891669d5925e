"""A part of the camera's picture, for networks that take pictures of one size."""

from dataclasses import replace

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, PRNGKeyArray

from sims.sensors.camera import Camera


def random_window(camera: Camera, width: int, height: int, *, key: PRNGKeyArray) -> Camera:
    """The camera of a random window of `width` x `height` pixels of its picture.

    Where the window is the larger, it goes beyond the picture by as much on both sides: 128 rows of a D435
    decimated by 4 are 4 more at the top and at the bottom than its 120.
    """
    draws = jax.random.uniform(key, (2,))
    return replace(
        camera,
        cx=camera.cx - _first_pixel(camera.width - width, draws[0]),
        cy=camera.cy - _first_pixel(camera.height - height, draws[1]),
        width=width,
        height=height,
    )


def _first_pixel(spare: int, draw: Float[Array, ""]) -> Float[Array, ""]:
    return jnp.floor(draw * (spare + 1)) if spare > 0 else jnp.full_like(draw, 0.5 * spare)


def ray_at(camera: Camera, place: Float[Array, "2"]) -> Float[Array, "3"]:
    """The ray, with z = 1, of the place (right, down) in the picture: (0, 0) its middle, 1 its edges."""
    half = 0.5 * jnp.asarray([camera.width, camera.height], place.dtype)
    pixel = half - 0.5 + place * half
    return jnp.stack(
        [(pixel[0] - camera.cx) / camera.fx, (pixel[1] - camera.cy) / camera.fy, jnp.ones_like(pixel[0])]
    )
