"""Scores of the paint on the wall, one world at a time, on the host."""

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Bool, Float
from scipy.spatial import KDTree

from sims.paint.grid import PaintGrid
from sims.scoring.wanted import CELL, Wanted, densify

PAINTED_SHARE = 0.2  # of the nominal film: thinner paint does not hide the wall
_JUMP = 0.020  # between neighbouring samples of a brush that was moved, not swept [m]


@dataclass(frozen=True)
class PaintScore:
    """How well one wall was painted; NaN where a figure does not exist (nothing was painted).

    coverage: share of the wanted area on the surface that got paint [1]. excess: painted area further than
    5 mm outside the wanted area, over the wanted area [1]. thickness_cv: standard deviation over mean of the
    film on the painted wanted area [1]. gap_length: bare length of centre-lines between painted stretches of
    the same line [m]; bare ends and whole lines that were left out are a matter of coverage. stroke_error:
    symmetric distance between the true pen-down brush centre and the centre-lines on the surface [m].
    """

    coverage: float
    excess: float
    thickness_cv: float
    gap_length: float
    stroke_error_mean: float
    stroke_error_p95: float


def score_paint(
    wanted: Wanted,
    grid: PaintGrid,
    thickness: Float[np.ndarray, "rows columns"],
    uv_brush: Float[np.ndarray, "time 2"],
    down: Bool[np.ndarray, "time"],
    *,
    film: float,
    stray: float = 0.0,
) -> PaintScore:
    """All paint scores of one world.

    thickness: film on `grid` [m]. uv_brush, down: true brush centre on the wall [m] in the order of time, and
    whether it counts (live and pen down). film: nominal [m]. stray: volume laid past the grid [m^3], which
    counts as excess at nominal thickness.
    """
    picture = _at_wanted_cells(thickness, grid, wanted)
    least = PAINTED_SHARE * film
    film_on_wanted = picture.ravel()[wanted.cells]
    painted = film_on_wanted >= least
    spilt = (picture >= least) & wanted.outside
    mean, p95 = _stroke_error(wanted, _track(uv_brush, down))
    return PaintScore(
        coverage=float(painted.mean()),
        excess=float((np.count_nonzero(spilt) * CELL**2 + stray / film) / wanted.area),
        thickness_cv=_variation(film_on_wanted[painted]),
        gap_length=sum(_gaps(line, picture.ravel()[wanted.index(line)] >= least) for line in wanted.lines),
        stroke_error_mean=mean,
        stroke_error_p95=p95,
    )


def score_paint_worlds(
    wanted: Wanted,
    grid: PaintGrid,
    thickness: Float[np.ndarray, "worlds rows columns"],
    uv_brush: Float[np.ndarray, "worlds time 2"],
    down: Bool[np.ndarray, "worlds time"],
    *,
    film: float,
    stray: Float[np.ndarray, "worlds"] | None = None,
) -> list[PaintScore]:
    """`score_paint` for many worlds, on as many threads as there are cores."""
    lost: Sequence[float] = np.zeros(len(thickness)).tolist() if stray is None else np.asarray(stray).tolist()
    # Made once, before threads would make them several times over.
    _ = wanted.cells, wanted.outside, wanted.area

    def one(world: int) -> PaintScore:
        track = uv_brush[world], down[world]
        return score_paint(wanted, grid, thickness[world], *track, film=film, stray=lost[world])

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(one, range(len(thickness))))


def _at_wanted_cells(thickness: np.ndarray, grid: PaintGrid, wanted: Wanted) -> np.ndarray:
    """The film [m] at the middles of the wanted picture's cells, bilinear."""
    cell, origin = float(grid.cell), np.asarray(grid.origin, float)
    scale, shift = CELL / cell, (wanted.origin - origin) / cell
    to_source = np.array([[scale, 0, shift[0]], [0, scale, shift[1]]])
    rows, columns = wanted.centre_distance.shape
    flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    source = np.nan_to_num(np.asarray(thickness, np.float32), posinf=0)
    return cv2.warpAffine(source, to_source, (columns, rows), flags=flags, borderMode=cv2.BORDER_REPLICATE)


def _variation(film: np.ndarray) -> float:
    return float(film.std(dtype=float) / film.mean(dtype=float)) if len(film) else float("nan")


def _gaps(line: np.ndarray, painted: np.ndarray) -> float:
    """Length [m] of the bare parts of a line that have paint before and after; a ring has no ends."""
    if not painted.any():
        return 0.0
    steps = np.linalg.norm(np.diff(line, axis=0), axis=1)
    share = 0.5 * (np.append(steps, 0) + np.insert(steps, 0, 0))
    first, last = np.flatnonzero(painted)[[0, -1]]
    ring = len(line) > 2 and np.linalg.norm(line[0] - line[-1]) < CELL
    between = np.arange(len(line))
    inside = ring | ((between > first) & (between < last))
    return float(share[inside & ~painted].sum())


def _track(uv: np.ndarray, down: np.ndarray) -> np.ndarray:
    """The swept brush centre at even steps of a cell, so that a brush at rest weighs no more."""
    down = down & np.isfinite(uv).all(1)
    near = np.linalg.norm(np.diff(np.where(down[:, None], uv, 0), axis=0), axis=1) < _JUMP
    cuts = np.flatnonzero(~(down[1:] & down[:-1] & near)) + 1
    pieces = [p for p, d in zip(np.split(uv, cuts), np.split(down, cuts), strict=True) if d[0]]
    return np.concatenate([densify(p, CELL) for p in pieces]) if pieces else np.zeros((0, 2))


def _stroke_error(wanted: Wanted, track: np.ndarray) -> tuple[float, float]:
    """Mean and 95th percentile [m] of the distances both ways, each way with half of the weight."""
    if not len(track):
        return float("nan"), float("nan")
    to_lines = wanted.tree.query(track)[0]
    to_track = KDTree(track).query(wanted.tree.data)[0]
    distances = np.concatenate([to_lines, to_track])
    weights = np.repeat([0.5 / len(to_lines), 0.5 / len(to_track)], [len(to_lines), len(to_track)])
    order = np.argsort(distances)
    p95 = distances[order][np.searchsorted(np.cumsum(weights[order]), 0.95)]
    return float((distances * weights).sum()), float(p95)
