"""The cells on the wall that hold paint."""

import math
from typing import Self

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from jaxpaint.errors import InputError
from jaxpaint.mapping.canvas import Canvas
from sims.scenes.scene import Scene

_OFF_WALL = 0.010  # what is hit further than this from the chart's surface is something else [m]
_RAYS = 4096  # that are cast at once


class PaintGrid(eqx.Module):
    """Square cells on the wall's own (u, v), metres of arc length.

    origin: (u, v) of the middle of cell [0, 0]. cell: edge length [m]. shape: rows (growing with v, so row 0
    is the lowest) and columns (growing with u, to the robot's right).
    """

    origin: Float[Array, "2"]
    cell: Float[Array, ""]
    shape: tuple[int, int] = eqx.field(static=True)

    @classmethod
    def covering(cls, lower: np.ndarray, upper: np.ndarray, cell: float) -> Self:
        """The smallest grid of whole cells over a rectangle of (u, v) [m]; host only, it fixes the shape."""
        columns, rows = (
            max(1, math.ceil((high - low) / cell)) for low, high in zip(lower, upper, strict=True)
        )
        origin = np.asarray(lower, float) + 0.5 * cell
        return cls(origin=jnp.asarray(origin, float), cell=jnp.asarray(cell, float), shape=(rows, columns))

    def to_cells(self, uv: Float[Array, "*points 2"]) -> Float[Array, "*points 2"]:
        """Fractional (column, row) of points; whole numbers are the middles of cells."""
        return (uv - self.origin) / self.cell

    def centres(self) -> Float[Array, "rows columns 2"]:
        """(u, v) of all cells [m]."""
        rows, columns = self.shape
        u = self.origin[0] + self.cell * jnp.arange(columns)
        v = self.origin[1] + self.cell * jnp.arange(rows)
        return jnp.stack(jnp.meshgrid(u, v), axis=-1)


def canvas_extent(
    scene: Scene, canvas: Canvas, *, margin: float, samples: int = 64
) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest (u, v) of the wall that the canvas's rays meet, with a margin [m]; host only.

    Raises InputError where no ray meets the wall.
    """
    half = 0.5 * np.asarray(canvas.size)
    across = [np.linspace(-h, h, samples) for h in half]
    uv_wall, valid = pose_all_on_wall(scene, canvas, np.stack(np.meshgrid(*across), axis=-1).reshape(-1, 2))
    met = uv_wall[valid]
    if not len(met):
        raise InputError("--canvas-pose: no ray of the canvas meets the wall; place it in front of the wall")
    lower = np.maximum(met.min(0) - margin, np.asarray(scene.chart.lower))
    upper = np.minimum(met.max(0) + margin, np.asarray(scene.chart.upper))
    return lower, upper


def pose_on_wall(
    scene: Scene, canvas: Canvas, uv_canvas: Float[Array, "2"]
) -> tuple[Float[Array, "2"], Bool[Array, ""]]:
    """Where the ray of a point of the canvas truly meets the wall, as (u, v) [m], and whether it does.

    A ray that first meets something that is not the wall's surface (the floor, a thing in front) does not.
    """
    origin = canvas.to_map(uv_canvas)
    hit = scene.raycast(origin, canvas.ray)
    uv, height = scene.chart.to_uv(origin + jnp.where(hit.valid, hit.distance, 0) * canvas.ray)
    return uv, hit.valid & (jnp.abs(height) < _OFF_WALL) & scene.chart.on_surface(uv)


def pose_all_on_wall(
    scene: Scene, canvas: Canvas, uv_canvas: Float[np.ndarray, "points 2"]
) -> tuple[Float[np.ndarray, "points 2"], Bool[np.ndarray, "points"]]:
    """`pose_on_wall` for many points, host only; always as many at a time, so one compilation a scene."""
    starts = range(0, len(uv_canvas), _RAYS)
    parts = [_pose_rays(scene, canvas, _padded(uv_canvas[k : k + _RAYS], canvas)) for k in starts]
    uv, valid = (np.concatenate([np.asarray(part[i]) for part in parts]) for i in (0, 1))
    return uv[: len(uv_canvas)], valid[: len(uv_canvas)]


@jax.jit
def _pose_rays(scene: Scene, canvas: Canvas, uv_canvas: Float[Array, "rays 2"]):
    return jax.vmap(lambda uv: pose_on_wall(scene, canvas, uv))(uv_canvas)


def _padded(uv_canvas: np.ndarray, canvas: Canvas) -> Float[Array, "rays 2"]:
    missing = _RAYS - len(uv_canvas)
    return jnp.asarray(np.pad(uv_canvas, ((0, missing), (0, 0)), mode="edge"), canvas.size.dtype)
