"""The cells of the wall that scores look at: which exist, what the canvas's rays see of them, and where paint
cannot be asked to end exactly.
"""

from dataclasses import dataclass

import cv2
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from jaxpaint.mapping.canvas import Canvas
from sims.paint.grid import pose_all_on_wall
from sims.scenes.charts import AbstractChart
from sims.scenes.scene import Scene

CELL = 0.001  # of the wanted picture [m]
MARGIN = 0.005  # of paint about the ink that is no fault yet: the contract's [m]
_STRIP = 0.010  # beside a brush, left out along a fold: what the mapper drops there [m]
_SHARP = np.radians(30.0)  # between normals a few cells apart: a fold; a column of 8 mm radius is none [rad]
_STRIDE = 4  # cells between normals: a sixteenth of the work
_SAME = 0.005  # a ray that comes back to a cell within this saw that cell: some cells, no other sheet [m]


@dataclass(frozen=True, eq=False)
class Ground:
    """The wall's (u, v) in cells of 1 mm; row 0 is the lowest.

    origin: (u, v) of the middle of cell [0, 0]. on_surface: cells where the wall exists.
    """

    origin: Float[np.ndarray, "2"]
    on_surface: Bool[np.ndarray, "rows columns"]

    @classmethod
    def of(cls, scene: Scene, extent: tuple[np.ndarray, np.ndarray]) -> "Ground":
        """The cells between the lowest and the highest (u, v) [m]."""
        lower, upper = (np.asarray(corner, float) for corner in extent)
        columns, rows = np.ceil((upper - lower) / CELL).astype(int)
        origin = lower + 0.5 * CELL
        axes = _axes(scene.chart, origin, (int(rows), int(columns)))
        return cls(origin, np.asarray(_on_surface(scene.chart, *axes)))

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return self.on_surface.shape

    def index(self, uv: Float[np.ndarray, "points 2"]) -> np.ndarray:
        """Flat index of the cell that holds each point; points outside get the nearest border cell."""
        rows, columns = self.shape
        column, row = np.rint((uv - self.origin) / CELL).astype(int).T
        return np.clip(row, 0, rows - 1) * columns + np.clip(column, 0, columns - 1)

    def uv(self, cells: np.ndarray) -> Float[np.ndarray, "points 2"]:
        """Middles of cells [m], from their flat indices."""
        row, column = np.divmod(cells, self.shape[1])
        return self.origin + CELL * np.stack([column, row], axis=-1)

    def on_canvas(self, scene: Scene, canvas: Canvas) -> Float[np.ndarray, "rows columns 2"]:
        """Where on the canvas [m] the ray through each cell starts; NaN off the surface."""
        points = np.array(_on_canvas(scene.chart, canvas, *_axes(scene.chart, self.origin, self.shape)))
        points[~self.on_surface] = np.nan
        return points

    def seen(
        self, scene: Scene, canvas: Canvas, on_canvas: Float[np.ndarray, "rows columns 2"], cells: np.ndarray
    ) -> Bool[np.ndarray, "cells"]:
        """Whether the canvas's rays through these cells meet them first: nothing before, no other sheet."""
        if not len(cells):
            return np.zeros(0, bool)
        uv, valid = pose_all_on_wall(scene, canvas, on_canvas.reshape(-1, 2)[cells])
        return valid & (np.linalg.norm(uv - self.uv(cells), axis=1) < _SAME)

    def paintable(
        self, chart: AbstractChart, radius: float, cut: Bool[np.ndarray, "rows columns"]
    ) -> Bool[np.ndarray, "rows columns"]:
        """Cells so far from every rim and fold that paint can end there wherever the picture asks.

        A brush of this radius [m] paints to a rim only with its middle beside it, and leaves out the strip of
        its radius and 10 mm along a fold; 5 mm are added to both. cut: cells that the rays do not reach. The
        grid's border is a rim where the wall itself ends there.
        """
        beyond = self._with_ends(~self.on_surface | cut, chart)
        near = _within(beyond, radius + MARGIN)[1:-1, 1:-1]
        return ~near & ~_within(self._folds(chart), radius + _STRIP + MARGIN)

    def _with_ends(self, gone: np.ndarray, chart: AbstractChart) -> Bool[np.ndarray, "rows+2 columns+2"]:
        """Cells without wall, with one more on each side: without, where the chart ends before it."""
        size = CELL * np.asarray(self.shape[::-1])
        left, below = self.origin - CELL < np.asarray(chart.lower)
        right, above = self.origin + size > np.asarray(chart.upper)
        padded = np.pad(gone, 1)
        padded[0] |= below
        padded[-1] |= above
        padded[:, 0] |= left
        padded[:, -1] |= right
        return padded

    def _folds(self, chart: AbstractChart) -> Bool[np.ndarray, "rows columns"]:
        """Cells about which the true normal turns sharply."""
        u, v = _axes(chart, self.origin, self.shape)
        normals = np.asarray(_normals(chart, u[::_STRIDE], v[::_STRIDE]))
        least = np.cos(_SHARP)
        turned = np.zeros(normals.shape[:2], bool)
        turned[:, 1:] |= (normals[:, 1:] * normals[:, :-1]).sum(-1) < least
        turned[1:] |= (normals[1:] * normals[:-1]).sum(-1) < least
        rows, columns = self.shape
        return np.repeat(np.repeat(turned, _STRIDE, 0), _STRIDE, 1)[:rows, :columns]


def _within(cells: np.ndarray, reach: float) -> np.ndarray:
    """Cells at most `reach` [m] from any of these."""
    if not cells.any():
        return np.zeros_like(cells)
    return distance_to(cells) <= reach


def distance_to(cells: Bool[np.ndarray, "rows columns"]) -> Float[np.ndarray, "rows columns"]:
    """Distance [m] from the middle of each cell to the middle of the nearest of these."""
    away = cv2.distanceTransform((~cells).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
    return away * np.float32(CELL)


def _axes(chart: AbstractChart, origin: np.ndarray, shape: tuple[int, int]):
    dtype = chart.lower.dtype
    u, v = (origin[axis] + CELL * np.arange(count) for axis, count in ((0, shape[1]), (1, shape[0])))
    return jnp.asarray(u, dtype), jnp.asarray(v, dtype)


def _by_rows(function, u: Float[Array, "columns"], v: Float[Array, "rows"]):
    """A function of (u, v) at all cells, row by row: all at once may not fit into memory."""

    def row(height):
        return jax.vmap(lambda across: function(jnp.stack([across, height])))(u)

    return jax.lax.map(row, v)


@jax.jit
def _on_surface(chart: AbstractChart, u: Float[Array, "columns"], v: Float[Array, "rows"]):
    return _by_rows(chart.on_surface, u, v)


@jax.jit
def _normals(chart: AbstractChart, u: Float[Array, "columns"], v: Float[Array, "rows"]):
    return _by_rows(chart.normal, u, v)


@jax.jit
def _on_canvas(chart: AbstractChart, canvas: Canvas, u: Float[Array, "columns"], v: Float[Array, "rows"]):
    return _by_rows(lambda uv: canvas.to_canvas(chart.point(uv))[0], u, v)
