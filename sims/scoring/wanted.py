"""Where paint is wanted: the picture's ink on the true surface, found without the mapper or the planner."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.spatial import KDTree

from jaxpaint.errors import InputError
from jaxpaint.mapping.canvas import Canvas
from jaxpaint.pictures.drawing import Drawing
from sims.scenes.scene import Scene
from sims.scoring.even_odd import FilledAreas
from sims.scoring.ground import CELL, MARGIN, Ground, distance_to
from sims.scoring.lines import STEP, densify, pose_lines

_SUBPIXEL = 4  # fractional bits of cv2's line drawing


@dataclass(frozen=True, eq=False)
class Layer:
    """What is wanted of one colour, on the cells of `Wanted`.

    centre_distance: from each cell to the nearest centre-line [m], infinite without one. ink_distance: to the
    boundary of what the rays see of the filled areas [m], below zero inside, infinite without areas. lines:
    centre-lines on the surface [m], cut wherever the surface is missed or jumps; tree: all their points.
    edge_tree: points of the areas' boundary on the surface, one for each `STEP` of it on the canvas; not
    where the surface itself ends, nor where ink of the same colour goes on. mask: cells that should get
    paint: filled, or within a brush radius of a centre-line, and on the surface. outside: cells of the
    surface where paint of this colour is in excess, be it that another is wanted there. paintable: cells
    where paint can end exactly, see `Ground.paintable`. edge_wanted: length of the areas' boundary on the
    surface, also where paint cannot end exactly [m].
    """

    centre_distance: Float[np.ndarray, "rows columns"]
    ink_distance: Float[np.ndarray, "rows columns"]
    lines: tuple[Float[np.ndarray, "points 2"], ...]
    tree: KDTree | None
    edge_tree: KDTree | None
    mask: Bool[np.ndarray, "rows columns"]
    outside: Bool[np.ndarray, "rows columns"]
    paintable: Bool[np.ndarray, "rows columns"]
    edge_wanted: float

    @cached_property
    def cells(self) -> np.ndarray:
        """Flat indices of the wanted cells."""
        return np.flatnonzero(self.mask)

    @cached_property
    def line_length(self) -> float:
        """Of all centre-lines on the surface [m]."""
        return float(sum(np.linalg.norm(np.diff(line, axis=0), axis=1).sum() for line in self.lines))

    @cached_property
    def edge_length(self) -> float:
        """Of the areas' boundary where paint can end exactly, as on the canvas [m]: that is judged."""
        return 0.0 if self.edge_tree is None else STEP * self.edge_tree.n


@dataclass(frozen=True, eq=False)
class Wanted:
    """The ink on the surface, on 1 mm cells of the wall's (u, v), colour by colour.

    ground: the cells. layers: one a colour, in the order of painting. radius: of the brush [m].
    """

    ground: Ground
    layers: tuple[Layer, ...]
    radius: float

    @property
    def origin(self) -> Float[np.ndarray, "2"]:
        """(u, v) of the middle of cell [0, 0] [m]."""
        return self.ground.origin

    @property
    def on_surface(self) -> Bool[np.ndarray, "rows columns"]:
        """Cells where the wall exists."""
        return self.ground.on_surface

    @cached_property
    def mask(self) -> Bool[np.ndarray, "rows columns"]:
        """Cells that should get paint of any colour."""
        return np.any([layer.mask for layer in self.layers], axis=0)

    @cached_property
    def colour(self) -> Int[np.ndarray, "rows columns"]:
        """The last colour that is wanted on each cell, -1 for none."""
        top = np.full(self.ground.shape, -1, np.int16)
        for number, layer in enumerate(self.layers):
            top[layer.mask] = number
        return top

    @cached_property
    def area(self) -> float:
        """Wanted area of all colours together [m^2]."""
        return sum(len(layer.cells) for layer in self.layers) * CELL**2

    @cached_property
    def judged(self) -> float:
        """Share of the areas' boundary on the surface where paint can end exactly; 1 without areas [1]."""
        whole = sum(layer.edge_wanted for layer in self.layers)
        return sum(layer.edge_length for layer in self.layers) / whole if whole else 1.0

    @property
    def lines(self) -> tuple[Float[np.ndarray, "points 2"], ...]:
        """Centre-lines of all colours on the surface [m]."""
        return tuple(line for layer in self.layers for line in layer.lines)

    def index(self, uv: Float[np.ndarray, "points 2"]) -> np.ndarray:
        """Flat index of the cell that holds each point; points outside get the nearest border cell."""
        return self.ground.index(uv)


def wanted_area(
    picture: Drawing | Sequence[Float[np.ndarray, "points 2"]],
    scene: Scene,
    canvas: Canvas,
    extent: tuple[np.ndarray, np.ndarray],
    radius: float,
    *,
    outlines: bool = False,
) -> Wanted:
    """Poses the ink of a picture on the true surface along the canvas's rays, without any alignment.

    picture: in metres on the canvas, from its middle (after `fit`); bare lines are a picture of one colour.
    scene: the truth, with `raycast` and `chart`. extent: lowest and highest (u, v) of the picture to make
    [m], as for the paint grid. radius: of the brush, to which lines are widened [m]. outlines: areas are
    wanted as their rings, painted as lines. Raises InputError where nothing of the picture meets the wall.
    """
    ground = Ground.of(scene, extent)
    parts = _by_colour(picture, outlines)
    fills = [FilledAreas(areas) for _, areas in parts]
    inks, cut = _posed_areas(fills, ground, scene, canvas)
    paintable = ground.paintable(scene.chart, radius, cut) if any(fill.rings for fill in fills) else None
    layers = []
    for (lines, _), fill, ink in zip(parts, fills, inks, strict=True):
        posed = tuple(pose_lines([densify(line, STEP) for line in lines], scene, canvas))
        tree = KDTree(np.concatenate(posed)) if posed else None
        away = _line_distance(posed, tree, ground, radius)
        edge = _edge(fill, scene, canvas, ground, away > radius)
        layers.append(_layer(ground, posed, tree, away, ink, edge, radius, paintable))
    wanted = Wanted(ground, tuple(layers), float(radius))
    if not wanted.area and not wanted.lines:
        raise InputError("--canvas-pose: no ink of the picture meets the wall; place the canvas before it")
    return wanted


def _by_colour(picture: Drawing | Sequence[np.ndarray], outlines: bool) -> list[tuple[list, list]]:
    """Lines and areas (as rings) of each colour."""
    if not isinstance(picture, Drawing):
        return [(list(picture), [])]
    parts: list[tuple[list, list]] = [([], []) for _ in picture.colours]
    for line, colour in zip(picture.lines, picture.line_colours, strict=True):
        parts[colour][0].append(line)
    for area in picture.areas:
        if outlines:
            parts[area.colour][0].extend(area.rings)
        else:
            parts[area.colour][1].append(area.rings)
    return parts


def _layer(ground: Ground, lines, tree, away, ink, edge, radius: float, paintable) -> Layer:
    paintable = ground.on_surface if paintable is None else paintable
    judged = edge[paintable.ravel()[ground.index(edge)]]
    edge_tree = KDTree(judged) if len(judged) else None
    depth = _ink_distance(ink, edge_tree, ground)
    return Layer(
        centre_distance=away,
        ink_distance=depth,
        lines=lines,
        tree=tree,
        edge_tree=edge_tree,
        mask=((away <= radius) | ink) & ground.on_surface,
        outside=(away > radius + MARGIN) & (depth > MARGIN) & ground.on_surface,
        paintable=paintable,
        edge_wanted=STEP * len(edge),
    )


def _posed_areas(
    fills: Sequence[FilledAreas], ground: Ground, scene: Scene, canvas: Canvas
) -> tuple[list[np.ndarray], np.ndarray]:
    """Per colour the cells that the rays of its areas meet, and the cells that something keeps them from.

    Every cell looks back along its ray to the canvas: exact on any surface, and no cell is left out.
    """
    none = np.zeros(ground.shape, bool)
    if not any(fill.rings for fill in fills):
        return [none] * len(fills), none
    on_canvas = ground.on_canvas(scene, canvas)
    flat = on_canvas.reshape(-1, 2)
    inks = [fill.contains(flat).reshape(ground.shape) if fill.rings else none for fill in fills]
    asked = np.flatnonzero(np.any(inks, axis=0))
    hidden = none.copy()
    hidden.ravel()[asked] = ~ground.seen(scene, canvas, on_canvas, asked)
    return [ink & ~hidden for ink in inks], hidden


def _edge(fill: FilledAreas, scene: Scene, canvas: Canvas, ground: Ground, beyond_lines) -> np.ndarray:
    """Points of the boundary of the areas on the surface, where paint should end."""
    rings = list(fill.edges(STEP))
    pieces = list(pose_lines([ring for ring, _ in rings], scene, canvas, [ends for _, ends in rings]))
    if not pieces:
        return np.zeros((0, 2))
    points = np.concatenate(pieces)
    return points[beyond_lines.ravel()[ground.index(points)]]


def _line_distance(
    lines: Sequence[np.ndarray], tree: KDTree | None, ground: Ground, radius: float
) -> np.ndarray:
    """Distance [m] from the middle of each cell to the nearest line: to a cell, and exact near the limits."""
    if tree is None:
        return np.broadcast_to(np.float32(np.inf), ground.shape)
    picture = np.full(ground.shape, 255, np.uint8)
    fixed = [np.rint((line - ground.origin) / CELL * 2**_SUBPIXEL).astype(np.int32) for line in lines]
    cv2.polylines(picture, fixed, isClosed=False, color=0, shift=_SUBPIXEL)
    distance = cv2.distanceTransform(picture, cv2.DIST_L2, cv2.DIST_MASK_PRECISE) * np.float32(CELL)
    # Lines as whole cells would make the areas some per cent too large.
    limits = radius, radius + MARGIN
    near = np.flatnonzero(np.any([np.abs(distance - limit) < 1.5 * CELL for limit in limits], axis=0))
    distance.ravel()[near] = tree.query(ground.uv(near), workers=-1)[0]
    return distance


def _ink_distance(ink: np.ndarray, edge_tree: KDTree | None, ground: Ground) -> np.ndarray:
    """Signed distance [m] to the boundary of inked cells: to a cell, exact where excess begins."""
    if not ink.any():
        return np.broadcast_to(np.float32(np.inf), ground.shape)
    half = np.float32(0.5 * CELL)
    inner = distance_to(~ink) - half if not ink.all() else np.float32(np.inf)
    distance = np.where(ink, -inner, distance_to(ink) - half)
    if edge_tree is not None:
        near = np.flatnonzero(np.abs(distance - MARGIN) < 1.5 * CELL)
        exact = edge_tree.query(ground.uv(near), workers=-1)[0]
        # Where the surface itself cut the ink, the cells know better than the picture's boundary.
        same = np.abs(exact - distance.ravel()[near]) < CELL
        distance.ravel()[near[same]] = exact[same]
    return distance
