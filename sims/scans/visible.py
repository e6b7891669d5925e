"""Samples of the true surface that a scan saw, evenly by area.

A mean over them estimates the mean over a sampling of the visible surface as fine as one likes: they are the
Q of the chamfer distance S1-(1) from truth to cloud, where a grid of 1 mm would have a million points.
"""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int, PRNGKeyArray

from jaxpaint.kinematics.pose import Pose
from sims.scenes.scene import Scene
from sims.sensors.camera import Camera, rotate
from sims.sensors.rgbd import RGBD

# Rays for each sample that is wanted. Their weights are nearly equal, so that few points come twice.
_RAYS_PER_SAMPLE = 2
# What is seen more edge-on than this [cosine] is not counted: the area in a pixel has no limit there, and a
# few rays would outweigh all others. A D435 gives no value from 78 degrees on; these are 84.
_LEAST_COSINE = 0.1


class Visible(eqx.Module):
    """Points of the true surface in the map frame [m], row by row of the picture.

    valid: all, but none where the scan has no valid pixel. effective: how many equally weighted rays the
    weighted ones are worth, as a share of them: (sum w)^2 / (n sum w^2).
    """

    points: Float[Array, "count 3"]
    valid: Bool[Array, "count"]
    effective: Float[Array, ""]


def visible_surface(
    scene: Scene,
    T_map_camera: Pose,
    camera: Camera,
    truth: RGBD,
    valid: Bool[Array, "height width"],
    count: int,
    *,
    key: PRNGKeyArray,
) -> Visible:
    """`count` points of what the valid pixels saw, evenly by area, row by row.

    truth: the picture without noise. valid: of the picture with noise. The area dA that a solid angle dW sees
    is r^2 dW / cos(incidence) at range r. Importance sampling: pixels are drawn by the area about their
    centres, rays anywhere within those pixels, and hits by their area over that which their pixel was drawn
    with, which is nearly the same for all but pixels on edges. Hits out of the camera's range, and those more
    edge-on than 84 degrees, count nothing.
    """
    pixel_key, place_key, choice_key = jax.random.split(key, 3)
    rays = _RAYS_PER_SAMPLE * count
    area = jnp.where(truth.valid, _area(truth.depth, truth.incidence, _stretch(camera)), 0.0)
    proposed = jnp.where(valid, _largest_around(area), 0.0).reshape(-1)
    pixel = stratified(proposed, rays, key=pixel_key)
    along = _rays_within(camera, pixel, key=place_key)
    stretch = jnp.sqrt((along * along).sum(1))
    directions = rotate(T_map_camera.R, along / stretch[:, None])
    hits = jax.vmap(scene.raycast, in_axes=(None, 0))(T_map_camera.p, directions)
    depth = jnp.where(hits.valid, hits.distance, 1.0) / stretch
    cosine = jnp.abs((directions * hits.normal).sum(1))
    seen = hits.valid & (depth >= camera.near) & (depth <= camera.far) & (cosine >= _LEAST_COSINE)
    seen &= proposed[pixel] > 0
    area = _area(depth, cosine, stretch)
    weights = jnp.where(seen, area / jnp.where(seen, proposed[pixel], 1.0), 0.0)
    chosen = stratified(weights, count, key=choice_key)
    points = T_map_camera.p + jnp.where(seen, depth * stretch, 0.0)[:, None] * directions
    squares = jnp.maximum((weights**2).sum(), jnp.finfo(weights.dtype).tiny)
    return Visible(points[chosen], seen[chosen], weights.sum() ** 2 / (rays * squares))


def stratified(weights: Float[Array, "n"], count: int, *, key: PRNGKeyArray) -> Int[Array, "count"]:
    """Indices drawn in proportion to the weights, one from each of `count` equal shares of their sum, in
    rising order; any index where all weights are 0.
    """
    ends = jnp.cumsum(weights)
    shares = (jnp.arange(count) + jax.random.uniform(key, (count,), weights.dtype)) / count
    # "right": an index without weight is never found between two that have some.
    index = jnp.searchsorted(ends, shares * ends[-1], side="right", method="scan_unrolled")
    return jnp.minimum(index, weights.shape[0] - 1)


def _area(
    depth: Float[Array, "*s"], cosine: Float[Array, "*s"], stretch: Float[Array, "*s"]
) -> Float[Array, "*s"]:
    """Area of surface that a pixel sees, but for a constant: its solid angle is 1 / (fx fy stretch^3), its
    range is depth times stretch.
    """
    return depth**2 / (stretch * jnp.maximum(cosine, _LEAST_COSINE))


def _stretch(camera: Camera) -> Float[Array, "height width"]:
    """Length of each pixel's ray whose z is 1."""
    x = (jnp.arange(camera.width) - camera.cx) / camera.fx
    y = (jnp.arange(camera.height) - camera.cy) / camera.fy
    return jnp.sqrt(1 + x[None, :] ** 2 + y[:, None] ** 2)


def _largest_around(area: Float[Array, "height width"]) -> Float[Array, "height width"]:
    """The largest area of a pixel and its neighbours. Where a pixel on an object's edge sees the wall behind
    it too, that is many times the area at its centre: drawn by the latter, a few rays would count for many.
    """
    padded = jnp.pad(area, 1)
    rows = jnp.maximum(jnp.maximum(padded[:-2], padded[2:]), padded[1:-1])
    return jnp.maximum(jnp.maximum(rows[:, :-2], rows[:, 2:]), rows[:, 1:-1])


def _rays_within(camera: Camera, pixel: Int[Array, "n"], *, key: PRNGKeyArray) -> Float[Array, "n 3"]:
    """Rays with z = 1 anywhere within these pixels, numbered row by row."""
    place = jax.random.uniform(key, (2, pixel.shape[0])) - 0.5
    x = (pixel % camera.width + place[0] - camera.cx) / camera.fx
    y = (pixel // camera.width + place[1] - camera.cy) / camera.fy
    return jnp.stack([x, y, jnp.ones_like(x)], axis=1)
