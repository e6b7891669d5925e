"""Where paint is wanted: the picture's ink on the true surface, found without the mapper or the planner."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import cv2
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float
from scipy.spatial import KDTree

from jaxpaint.errors import InputError
from jaxpaint.mapping.canvas import Canvas
from sims.paint.grid import pose_all_on_wall
from sims.scenes.charts import AbstractChart
from sims.scenes.scene import Scene

CELL = 0.001  # of the wanted picture [m]
EXCESS_MARGIN = 0.005  # paint counts as excess further than this outside the wanted area [m]
STEP = 0.0005  # between points of a centre-line on the canvas [m]
_JUMP = 0.010  # between neighbours on the surface that belong to different sheets of it [m]
_SUBPIXEL = 4  # fractional bits of cv2's line drawing


@dataclass(frozen=True, eq=False)
class Wanted:
    """The ink on the surface, on 1 mm cells of the wall's (u, v); row 0 is the lowest.

    origin: (u, v) of the middle of cell [0, 0]. centre_distance: from each cell to the nearest centre-line
    [m]. on_surface: cells where the wall exists. lines: centre-lines on the surface [m], cut wherever the
    surface is missed or jumps. tree: all their points. radius: of the brush [m].
    """

    origin: Float[np.ndarray, "2"]
    centre_distance: Float[np.ndarray, "rows columns"]
    on_surface: Bool[np.ndarray, "rows columns"]
    lines: tuple[Float[np.ndarray, "points 2"], ...]
    tree: KDTree
    radius: float

    @cached_property
    def mask(self) -> Bool[np.ndarray, "rows columns"]:
        """Cells that should get paint: within a brush radius of a centre-line, and on the surface."""
        return (self.centre_distance <= self.radius) & self.on_surface

    @cached_property
    def cells(self) -> np.ndarray:
        """Flat indices of the wanted cells."""
        return np.flatnonzero(self.mask)

    @cached_property
    def outside(self) -> Bool[np.ndarray, "rows columns"]:
        """Cells of the surface where paint is in excess."""
        return (self.centre_distance > self.radius + EXCESS_MARGIN) & self.on_surface

    @cached_property
    def area(self) -> float:
        """Wanted area [m^2]."""
        return len(self.cells) * CELL**2

    def index(self, uv: Float[np.ndarray, "points 2"]) -> np.ndarray:
        """Flat index of the cell that holds each point; points outside get the nearest border cell."""
        rows, columns = self.centre_distance.shape
        column, row = np.rint((uv - self.origin) / CELL).astype(int).T
        return np.clip(row, 0, rows - 1) * columns + np.clip(column, 0, columns - 1)


def wanted_area(
    lines: Sequence[Float[np.ndarray, "points 2"]],
    scene: Scene,
    canvas: Canvas,
    extent: tuple[np.ndarray, np.ndarray],
    radius: float,
) -> Wanted:
    """Poses centre-lines on the true surface along the canvas's rays and widens them to the brush.

    lines: in metres on the canvas, from its middle (`Drawing.lines` after `fit`). scene: the truth, with
    `raycast` and `chart`. extent: lowest and highest (u, v) of the picture to make [m], as for the paint
    grid. Raises InputError where no line meets the wall.
    """
    lower, upper = (np.asarray(corner, float) for corner in extent)
    columns, rows = np.ceil((upper - lower) / CELL).astype(int)
    shape, origin = (int(rows), int(columns)), lower + 0.5 * CELL
    posed = tuple(_pose([densify(line, STEP) for line in lines], scene, canvas))
    if not posed:
        raise InputError(
            "--canvas-pose: no line of the picture meets the wall; place the canvas in front of it"
        )
    tree = KDTree(np.concatenate(posed))
    return Wanted(
        origin=origin,
        centre_distance=_distance_to(posed, tree, origin, shape, (radius, radius + EXCESS_MARGIN)),
        on_surface=_surface_mask(scene, origin, shape),
        lines=posed,
        tree=tree,
        radius=float(radius),
    )


def densify(line: Float[np.ndarray, "points 2"], step: float) -> Float[np.ndarray, "dense 2"]:
    """Points at even steps of at most `step` along a polyline, first and last included."""
    line = np.asarray(line, float)
    travelled = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    even = np.linspace(0, travelled[-1], max(int(np.ceil(travelled[-1] / step)), 1) + 1)
    return np.stack([np.interp(even, travelled, line[:, axis]) for axis in (0, 1)], axis=-1)


def _pose(lines: Sequence[np.ndarray], scene: Scene, canvas: Canvas) -> Iterator[np.ndarray]:
    """The parts of dense canvas lines that lie on one sheet of the surface each, as (u, v) of the wall."""
    uv, valid = pose_all_on_wall(scene, canvas, np.concatenate(lines))
    joined = valid[1:] & valid[:-1] & (np.linalg.norm(np.diff(uv, axis=0), axis=1) < _JUMP)
    joined[np.cumsum([len(line) for line in lines])[:-1] - 1] = False
    for piece, keep in zip(*(np.split(x, np.flatnonzero(~joined) + 1) for x in (uv, valid)), strict=True):
        if keep[0]:
            yield piece


def _surface_mask(scene: Scene, origin: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """Where the wall exists, row by row of the picture: all cells at once may not fit into memory."""
    v, u = (origin[axis] + CELL * np.arange(count) for axis, count in ((1, shape[0]), (0, shape[1])))
    dtype = scene.chart.lower.dtype
    return np.asarray(_on_surface(scene.chart, jnp.asarray(u, dtype), jnp.asarray(v, dtype)))


@jax.jit
def _on_surface(chart: AbstractChart, u: Float[Array, "columns"], v: Float[Array, "rows"]):
    def row(height):
        return jax.vmap(lambda across: chart.on_surface(jnp.stack([across, height])))(u)

    return jax.lax.map(row, v)


def _distance_to(
    lines: Sequence[np.ndarray],
    tree: KDTree,
    origin: np.ndarray,
    shape: tuple[int, int],
    limits: Sequence[float],
) -> np.ndarray:
    """Distance [m] from the middle of each cell to the nearest line: to a cell, and exact near the limits."""
    picture = np.full(shape, 255, np.uint8)
    fixed = [np.rint((line - origin) / CELL * 2**_SUBPIXEL).astype(np.int32) for line in lines]
    cv2.polylines(picture, fixed, isClosed=False, color=0, shift=_SUBPIXEL)
    distance = cv2.distanceTransform(picture, cv2.DIST_L2, cv2.DIST_MASK_PRECISE) * np.float32(CELL)
    # Lines as whole cells would make the areas some per cent too large.
    near = np.any([np.abs(distance - limit) < 1.5 * CELL for limit in limits], axis=0)
    rows, columns = np.nonzero(near)
    distance[near] = tree.query(origin + CELL * np.stack([columns, rows], axis=-1), workers=-1)[0]
    return distance
