"""The pinhole camera: pixels, rays and points."""

from typing import Self

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from sims.parameters import scalar


class Camera(eqx.Module):
    """A pinhole depth camera, OpenCV axes: z forward, x right, y down; pixel centres at whole numbers.

    fx, fy, cx, cy: intrinsics of the delivered image [px]. baseline: of the stereo pair behind it [m].
    near, far: range in which it measures [m]. decimation: how many sensor pixels one delivered pixel spans
    in each direction. The defaults are a D435's depth stream of 848 x 480 pixels, 87 x 58 degrees, decimated
    by 4; near is the maker's shortest distance at this resolution.
    """

    fx: Float[Array, ""] = eqx.field(converter=scalar, default=111.7)
    fy: Float[Array, ""] = eqx.field(converter=scalar, default=108.24)
    cx: Float[Array, ""] = eqx.field(converter=scalar, default=105.5)
    cy: Float[Array, ""] = eqx.field(converter=scalar, default=59.5)
    baseline: Float[Array, ""] = eqx.field(converter=scalar, default=0.050)
    near: Float[Array, ""] = eqx.field(converter=scalar, default=0.195)
    far: Float[Array, ""] = eqx.field(converter=scalar, default=6.0)
    width: int = eqx.field(static=True, default=212)
    height: int = eqx.field(static=True, default=120)
    decimation: int = eqx.field(static=True, default=4)

    @classmethod
    def with_field_of_view(
        cls, width: int, height: int, horizontal: float, vertical: float, **others
    ) -> Self:
        """A camera with the given size [px] and angles of view [rad], centred."""
        if not (0 < horizontal < jnp.pi and 0 < vertical < jnp.pi):
            raise ValueError(f"field of view: found {horizontal}, {vertical}; allowed is 0 to pi")
        fx, fy = 0.5 * width / jnp.tan(0.5 * horizontal), 0.5 * height / jnp.tan(0.5 * vertical)
        centre = {"cx": 0.5 * (width - 1), "cy": 0.5 * (height - 1)}
        return cls(fx=fx, fy=fy, width=width, height=height, **centre, **others)


def pixel_rays(camera: Camera) -> Float[Array, "height width 3"]:
    """Directions of all pixels in the camera frame, scaled to z = 1 (so depth times ray is the point)."""
    x = (jnp.arange(camera.width) - camera.cx) / camera.fx
    y = (jnp.arange(camera.height) - camera.cy) / camera.fy
    x, y = jnp.broadcast_arrays(x[None, :], y[:, None])
    return jnp.stack([x, y, jnp.ones_like(x)], axis=-1)


def back_project(camera: Camera, depth: Float[Array, "height width"]) -> Float[Array, "pixels 3"]:
    """Points of a depth image [m] in the camera frame, row by row."""
    return (depth[..., None] * pixel_rays(camera)).reshape(-1, 3)


def rotate(R: Float[Array, "3 3"], vectors: Float[Array, "*batch 3"]) -> Float[Array, "*batch 3"]:
    """R times each vector; multiplied out, because products on GPUs would round to TF32 (1e-3)."""
    return vectors[..., :1] * R[:, 0] + vectors[..., 1:2] * R[:, 1] + vectors[..., 2:] * R[:, 2]
