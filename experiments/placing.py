"""From options to the wall and the canvas on it."""

import dataclasses
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from experiments.commands.paint_options import PaintOptions
from jaxpaint.mapping.canvas import Canvas
from sims.scenes.canvases import canvas_for
from sims.scenes.captured import CapturedWall
from sims.scenes.mesh_walls import MeshWall, read_wall
from sims.scenes.scene import Scene
from sims.scenes.walls import make_wall


@dataclasses.dataclass(frozen=True)
class Placed:
    """The wall, the canvas on it, what to tell of a file, and what of it can be left open, as it is now."""

    scene: Scene
    canvas: Canvas
    notes: tuple[str, ...]
    found: Mapping[str, Any]


def placed(options: PaintOptions) -> Placed:
    """Makes the wall or reads its file. Raises InputError."""
    file = options.captured()
    if file is None:
        scene = make_wall(str(options.wall))
        canvas = canvas_for(scene, options.canvas_size, options.canvas_pose)
        return Placed(scene, canvas, (), _on_canvas(canvas))
    wall = _captured(options, file)
    canvas = canvas_for(wall.scene, options.canvas_size, options.canvas_pose, default=wall.canvas)
    return Placed(wall.scene, canvas, tuple(wall.report.lines()), _on_canvas(canvas) | _stance(wall))


def decimals(values) -> tuple[float, ...]:
    """The decimal numbers that rounded ones stand for: 0.4, not the float32 beside it; rounded, they give the
    same bits again.
    """
    return tuple(float(str(x)) for x in np.asarray(values).ravel())


def _captured(options: PaintOptions, file: Path) -> CapturedWall | MeshWall:
    """The wall of a file. What the run that is repeated chose in it is chosen again: bit for bit the same
    wall, and a guess is still called one. Where that gives something else, the values themselves count.
    """
    names = ("up", "wall_height", "canvas_size")

    def read(given: dict[str, Any]) -> CapturedWall | MeshWall:
        return read_wall(
            file,
            up=given["up"],
            scale=options.wall_scale,
            height=given["wall_height"],
            canvas_size=given["canvas_size"],
        )

    wanted = {name: getattr(options, name) for name in names}
    wall = read({name: None if name in options.chosen else value for name, value in wanted.items()})
    found = _stance(wall) | _on_canvas(wall.canvas)
    same = all(found[name] == wanted[name] for name in names if name in options.chosen)
    return wall if same else read(wanted)


def _stance(wall: CapturedWall | MeshWall) -> dict[str, Any]:
    return {"up": wall.report.up, "wall_height": float(wall.report.height)}


def _on_canvas(canvas: Canvas) -> dict[str, Any]:
    return {
        "canvas_size": decimals(canvas.size),
        "canvas_pose": (*decimals(canvas.center), *decimals(canvas.yaw)),
    }
