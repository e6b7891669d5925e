"""Pictures of slanted walls by a D435 at full resolution, by `observe`, to be fitted like real ones."""

import jax
import jax.numpy as jnp
import numpy as np

from sims.sensors import RGBD, Camera, DepthNoise, observe
from sims.sensors.plane_residual import PlaneResidual, plane_residual

_HEIGHT, _WIDTH = 180, 240
# Distance of the middle [m], and change of disparity along u and v [px/px]: walls seen from 20 to 40 degrees.
_VIEWS = ((0.4, 0.04, 0.01), (0.6, -0.02, 0.02), (0.8, 0.03, -0.01), (1.0, 0.01, 0.013), (1.5, -0.015, 0.005))


def full_camera() -> Camera:
    """A D435's depth stream without decimation, a window of it."""
    default = Camera()
    scale = default.decimation
    return Camera(
        fx=default.fx * scale,
        fy=default.fy * scale,
        cx=0.5 * (_WIDTH - 1),
        cy=0.5 * (_HEIGHT - 1),
        width=_WIDTH,
        height=_HEIGHT,
        decimation=1,
    )


def simulated_patches(noise: DepthNoise, seed: int) -> tuple[list[PlaneResidual], list[np.ndarray]]:
    """The residuals of all views, and their depths [m]; two pictures of each."""
    camera = full_camera()
    focal_baseline = float(camera.fx * camera.baseline)
    keys = jax.random.split(jax.random.key(seed), 2 * len(_VIEWS))
    pictures = [
        np.asarray(_OBSERVE(_wall(camera, *view), camera, noise, key=key).depth, float)
        for view, key in zip(_VIEWS * 2, keys, strict=True)
    ]
    return [plane_residual(depth, focal_baseline) for depth in pictures], pictures


def _wall(camera: Camera, distance: float, across: float, down: float) -> RGBD:
    v, u = np.indices((_HEIGHT, _WIDTH))
    focal_baseline = float(camera.fx * camera.baseline)
    disparity = focal_baseline / distance + across * (u - 0.5 * _WIDTH) + down * (v - 0.5 * _HEIGHT)
    shape = disparity.shape
    return RGBD(
        depth=jnp.asarray(focal_baseline / disparity, float),
        colour=jnp.full((*shape, 3), 0.5, float),
        incidence=jnp.ones(shape, float),
        valid=jnp.ones(shape, bool),
    )


_OBSERVE = jax.jit(observe)
