"""Lines of the canvas as they lie on the true surface."""

from collections.abc import Iterator, Sequence

import numpy as np
from jaxtyping import Bool, Float

from jaxpaint.mapping.canvas import Canvas
from sims.paint.grid import pose_all_on_wall
from sims.scenes.scene import Scene

STEP = 0.0005  # between points of a line on the canvas [m]
_JUMP = 0.010  # between neighbours on the surface that belong to different sheets of it [m]


def densify(line: Float[np.ndarray, "points 2"], step: float) -> Float[np.ndarray, "dense 2"]:
    """Points at even steps of at most `step` along a polyline, first and last included."""
    line = np.asarray(line, float)
    travelled = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    even = np.linspace(0, travelled[-1], max(int(np.ceil(travelled[-1] / step)), 1) + 1)
    return np.stack([np.interp(even, travelled, line[:, axis]) for axis in (0, 1)], axis=-1)


def pose_lines(
    lines: Sequence[Float[np.ndarray, "points 2"]],
    scene: Scene,
    canvas: Canvas,
    kept: Sequence[Bool[np.ndarray, "points"]] | None = None,
) -> Iterator[Float[np.ndarray, "points 2"]]:
    """The parts of dense canvas lines [m] that lie on one sheet of the surface each, as (u, v) of the wall.

    kept: which points of each line to keep at all.
    """
    if not len(lines):
        return
    uv, valid = pose_all_on_wall(scene, canvas, np.concatenate(lines))
    if kept is not None:
        valid = valid & np.concatenate(kept)
    joined = valid[1:] & valid[:-1] & (np.linalg.norm(np.diff(uv, axis=0), axis=1) < _JUMP)
    joined[np.cumsum([len(line) for line in lines])[:-1] - 1] = False
    for piece, keep in zip(*(np.split(x, np.flatnonzero(~joined) + 1) for x in (uv, valid)), strict=True):
        if keep[0]:
            yield piece
