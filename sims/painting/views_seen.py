"""What a set of camera poses truly sees of the operating area: ray casts, not the planner's model."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from jaxpaint.kinematics.pose import Pose
from jaxpaint.mapping.canvas import Canvas
from jaxpaint.planning import Viewpoints
from sims.scenes.scene import Scene
from sims.sensors import Camera, render

# Distance of neighbouring points that are asked for [m]: some pixels, and a few thousand points on a canvas.
_SPACING = 0.02
# A surface further behind the canvas is none of it; a pixel as near in depth shows the same surface [m].
_DEEPEST, _SAME = 1.5, 0.02


def seen_points(
    scene: Scene, canvas: Canvas, camera: Camera, views: Pose
) -> tuple[Float[np.ndarray, "n 3"], Bool[np.ndarray, " n"]]:
    """Points of the true surface behind a canvas [m], and whether some view has a valid pixel of each.

    views: T_map_camera, stacked. A point is seen where the pixel that it falls on measures its depth.
    """
    points = surface_behind(scene, canvas)
    seen = _SEEN(scene, camera, views, jnp.asarray(points))
    return points, np.asarray(seen)


def share_seen(scene: Scene, canvas: Canvas, camera: Camera, views: Viewpoints) -> float:
    """Share of the true surface behind a canvas that planned views see by ray casts, from where the plan has
    the camera; 0 where it cannot be brought there.
    """
    if not views.reachable:
        return 0.0
    poses = Pose(jnp.asarray(views.camera, float), jnp.asarray(views.rotation, float))
    _, seen = seen_points(scene, canvas, camera, poses)
    return float(seen.mean()) if len(seen) else 0.0


def surface_behind(scene: Scene, canvas: Canvas) -> Float[np.ndarray, "n 3"]:
    """Where the rays of a canvas meet the true surface, evenly over the canvas [m]."""
    axes = [np.linspace(-x / 2, x / 2, 1 + round(float(x) / _SPACING)) for x in canvas.size]
    uv = jnp.asarray(np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 2), float)
    origins, rays = canvas.to_map(uv), canvas.ray
    hits = jax.jit(jax.vmap(scene.raycast, in_axes=(0, None)))(origins, rays)
    met = np.asarray(hits.valid & (hits.distance <= _DEEPEST))
    return np.asarray(origins + hits.distance[:, None] * rays)[met]


def _seen(scene: Scene, camera: Camera, views: Pose, points: Float[Array, "n 3"]) -> Bool[Array, " n"]:
    def by(view):
        picture = render(scene, camera, view.p, view.R)
        x, y, z = jnp.moveaxis(((points - view.p)[:, :, None] * view.R).sum(1), -1, 0)
        ahead = jnp.maximum(z, 1e-6)
        column = jnp.round(x / ahead * camera.fx + camera.cx).astype(int)
        row = jnp.round(y / ahead * camera.fy + camera.cy).astype(int)
        inside = (column >= 0) & (column < camera.width) & (row >= 0) & (row < camera.height)
        at = jnp.clip(row, 0, camera.height - 1), jnp.clip(column, 0, camera.width - 1)
        return (z > 0) & inside & picture.valid[at] & (jnp.abs(picture.depth[at] - z) < _SAME)

    return jax.lax.map(by, views).any(0)


_SEEN = jax.jit(_seen)
