"""A mesh as the wall."""

from dataclasses import dataclass
from pathlib import Path

import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float
from scipy import ndimage

from jaxpaint.clouds import read_cloud
from jaxpaint.errors import InputError
from jaxpaint.mapping.canvas import Canvas
from sims.scenes.arc_length import ArcLengthChart, ArcScale
from sims.scenes.building import plaster, wooden_floor
from sims.scenes.canvases import CENTER_HEIGHT, make_canvas
from sims.scenes.captured import CapturedWall, captured
from sims.scenes.charts import HeightChart
from sims.scenes.heightfield import HeightField
from sims.scenes.heightmap import HeightMap
from sims.scenes.mesh_baking import MeshSurface, bake_mesh, smoothed
from sims.scenes.mesh_checks import check_mesh
from sims.scenes.mesh_files import is_mesh, read_mesh
from sims.scenes.mesh_report import MeshReport
from sims.scenes.mesh_stance import find_side
from sims.scenes.placing import Place, place_in
from sims.scenes.scene import Scene

# What stands further in front of the wall is where the robot drives.
_IN_FRONT = 1.2
_STAND_OFF = 0.05
# The part of a large mesh that is baked, about the canvas [m].
_WINDOW = (6.0, 4.0)
# A canvas lies between these heights, where an arm on a base reaches [m].
_LOWEST, _HIGHEST = 0.3, 1.9
# A mesh as tall as this stands on the floor where nobody says otherwise.
_TALL = 1.8
_MAX_TURN = np.tan(np.deg2rad(40.0))
_CALM, _SPECK = 0.015, 0.01


@dataclass(frozen=True)
class MeshWall:
    """The scene, the canvas on its largest free part, and the report."""

    scene: Scene
    canvas: Canvas
    report: MeshReport


def read_wall(
    path: str | Path,
    *,
    up: str | None = None,
    scale: float = 1.0,
    height: float | None = None,
    canvas_size: tuple[float, float] | None = None,
) -> MeshWall | CapturedWall:
    """The wall of a file: a mesh for .stl, .obj and .ply with faces, else a captured cloud."""
    if is_mesh(path):
        return mesh_wall(path, up=up, scale=scale, height=height, canvas_size=canvas_size)
    return captured(read_cloud(path, scale=scale), up=up, height=height, canvas_size=canvas_size)


def mesh_wall(
    path: str | Path,
    *,
    up: str | None = None,
    scale: float = 1.0,
    height: float | None = None,
    canvas_size: tuple[float, float] | None = None,
) -> MeshWall:
    """Turns a mesh so that the robot sees its wall near x = 0, and bakes that side to a surface.

    up: the file's axis that points up; None guesses. scale: turns its units into metres. height: of its
    lowest point above the floor [m]; None stands a tall mesh on the floor, and puts the middle of the canvas
    1.1 m high on others. canvas_size [m]: None takes the largest that fits between 0.3 and 1.9 m; one that
    fits nowhere else may lie over holes, where nothing is painted. Raises InputError for what is no wall.
    """
    if height is not None and not np.isfinite(height):
        raise InputError(f"--wall-height: {height} found, a finite length in metres is allowed")
    mesh = read_mesh(path, scale=scale)
    checks = check_mesh(mesh)
    stance = find_side(mesh, checks.sound, up)
    corners = mesh.corners[checks.sound] @ stance.R_wall_capture.T - np.array([stance.offset, 0.0, 0.0])
    lowest, highest = float(corners[:, :, 2].min()), float(corners[:, :, 2].max())
    level = 0.0 if height is None and highest - lowest > _TALL else height
    band = None if level is None else (_LOWEST + lowest - level, _HIGHEST + lowest - level)
    # A sheet may stand askew to its plane; of a solid the wall is what lies in front.
    front = float(corners[:, :, 0].min()) if stance.share > 0.5 else -_IN_FRONT
    surface = bake_mesh(corners, front, mesh.name)
    place = place_in(_choices(surface, band, canvas_size), surface.lattice, canvas_size, mesh.name)
    window = _window(place, surface)
    if window is not None:
        surface = bake_mesh(corners, front, mesh.name, window)
        place = place_in(_choices(surface, band, place.size), surface.lattice, place.size, mesh.name)
    rise = CENTER_HEIGHT - place.v if level is None else level - lowest
    depth = _in_front(surface, place)
    scene = _scene(surface, place, rise, depth, mesh.name)
    canvas = make_canvas(place.size, (-_STAND_OFF, 0.0, place.v + rise, 0.0))
    report = MeshReport.of(
        mesh, checks, stance, surface, place, np.array([depth, place.u, rise]), lowest + rise, height is None
    )
    return MeshWall(scene, canvas, report)


def _choices(
    surface: MeshSurface, band: tuple[float, float] | None, size: tuple[float, float] | None
) -> list[Bool[np.ndarray, "V U"]]:
    """Where a canvas may lie: on the wall where it faces the robot; one of a given size also over holes."""
    cell = surface.lattice.cell
    gentle = np.hypot(*np.gradient(smoothed(surface.samples, surface.wall, _CALM / cell), cell)) < _MAX_TURN
    z = surface.lattice.low + cell * np.arange(surface.lattice.shape[0])
    low, high = band or (-np.inf, np.inf)
    reached = ((z >= low) & (z <= high))[:, None]
    specks = max(1, int(_SPECK / cell))
    closed = ndimage.binary_closing(np.pad(surface.wall, specks), np.ones((3, 3)), iterations=specks)
    closed = closed[specks:-specks, specks:-specks] & gentle & reached
    if size is None:
        return [closed]
    return [closed, ndimage.binary_fill_holes(closed), _convex(surface.wall) & reached]


def _convex(wall: Bool[np.ndarray, "V U"]) -> Bool[np.ndarray, "V U"]:
    """Cells between wall on the left and right or below and above: holes, and bays of the rim."""

    def between(axis: int) -> np.ndarray:
        return np.logical_or.accumulate(wall, axis=axis) & np.flip(
            np.logical_or.accumulate(np.flip(wall, axis=axis), axis=axis), axis=axis
        )

    return between(0) | between(1)


def _window(place: Place, surface: MeshSurface) -> tuple[np.ndarray, np.ndarray] | None:
    """Lowest and highest (u, v) about the canvas, for a mesh so large that its cells would be coarse."""
    extent = np.array(surface.lattice.shape[::-1]) * surface.lattice.cell
    if np.all(extent <= np.array(_WINDOW)):
        return None
    middle, half = np.array([place.u, place.v]), 0.5 * np.array(_WINDOW)
    return middle - half, middle + half


def _in_front(surface: MeshSurface, place: Place) -> float:
    """Depth of the nearest thing that the canvas covers [m]: it goes to x = 0."""
    lattice = surface.lattice
    v, u = (
        low + lattice.cell * np.arange(n)
        for low, n in zip((lattice.low, lattice.left), lattice.shape, strict=True)
    )
    covered = (np.abs(v - place.v) <= 0.5 * place.size[1])[:, None] & (
        np.abs(u - place.u) <= 0.5 * place.size[0]
    )
    return float(surface.samples[covered & ~surface.empty].min())


def _scene(surface: MeshSurface, place: Place, rise: float, depth: float, name: str) -> Scene:
    lattice = surface.lattice
    left = lattice.left - place.u
    heights = HeightMap(
        depth=jnp.asarray(surface.coefficients - depth, dtype=float),
        valid=jnp.asarray(surface.valid),
        left=jnp.asarray(left, dtype=float),
        low=jnp.asarray(lattice.low + rise, dtype=float),
        cell=jnp.asarray(lattice.cell, dtype=float),
    )
    body = surface.coefficients[~surface.empty] - depth
    wall = HeightField(
        surface=heights,
        near=jnp.asarray(body.min() - 0.02, dtype=float),
        far=jnp.asarray(body.max() + 0.02, dtype=float),
        texture=plaster(),
        empty=jnp.asarray(surface.empty),
    )
    across = ArcScale.along(_profile(surface, 0), left, lattice.cell)
    up = ArcScale.along(_profile(surface, 1), lattice.low + rise, lattice.cell)
    return Scene((wall, wooden_floor()), ArcLengthChart.of(HeightChart.of(heights), across, up), name)


def _profile(surface: MeshSurface, axis: int) -> Float[np.ndarray, "N"]:
    """Mean slope of the wall by u (axis 0) or v (1), over the other; of the nearest wall where none is."""
    count = surface.wall.sum(axis=axis)
    total = np.where(surface.wall, surface.slopes[axis], 0.0).sum(axis=axis)
    nearest = ndimage.distance_transform_edt(count == 0, return_distances=False, return_indices=True)[0]
    return (total / np.maximum(count, 1))[nearest]
