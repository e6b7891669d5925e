"""Scores of the paint on the wall, one world at a time, on the host."""

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Bool, Float, Int

from sims.paint.grid import PaintGrid
from sims.scoring.ground import CELL
from sims.scoring.stroke_error import edge_part, line_part, pooled, track
from sims.scoring.wanted import Layer, Wanted

PAINTED_SHARE = 0.2  # of the nominal film: thinner paint does not hide the wall


@dataclass(frozen=True)
class PaintScore:
    """How well one wall was painted; NaN where a figure does not exist (nothing was painted).

    Every colour is judged by its own paint, whatever lies on top, and the colours are added up. coverage:
    share of the wanted area on the surface that got paint of its colour [1]. excess: painted area further
    than 5 mm outside the wanted area of that colour, also where another is wanted, over the wanted area [1].
    thickness_cv: standard deviation over mean of the film on the painted wanted area [1]. gap_length: bare
    length of centre-lines between painted stretches of the same line [m]; bare ends, whole lines that were
    left out and all of the areas are a matter of coverage: 0 in a picture without lines. stroke_error:
    symmetric distance [m], for lines between the true pen-down brush centre and the centre-lines on the
    surface, for areas between the paint's boundary and theirs; pooled by the length of what is wanted.

    A brush cannot end its paint exactly at a rim of the wall, at the shadow of something before it, or in a
    fold: boundaries within its radius and 5 mm of a rim or a shadow, or its radius and 15 mm of a fold, are
    not compared, neither the wanted nor the painted. stroke_error_judged: share of the wanted boundaries on
    the surface that are, by length; 1 in a picture without areas [1]. What is left out counts in coverage
    and excess all the same.
    """

    coverage: float
    excess: float
    thickness_cv: float
    gap_length: float
    stroke_error_mean: float
    stroke_error_p95: float
    stroke_error_judged: float


def score_paint(
    wanted: Wanted,
    grid: PaintGrid,
    thickness: Float[np.ndarray, "*colours rows columns"],
    uv_brush: Float[np.ndarray, "time 2"],
    down: Bool[np.ndarray, "time"],
    *,
    film: float,
    stray: float = 0.0,
    colour: Int[np.ndarray, "time"] | None = None,
) -> PaintScore:
    """All paint scores of one world.

    thickness: film on `grid` [m], of each colour of `wanted`; without the axis of colours there is one.
    uv_brush, down: true brush centre on the wall [m] in the order of time, and whether it counts (live and
    pen down). film: nominal [m]. stray: volume laid past the grid [m^3], which counts as excess at nominal
    thickness. colour: in hand, the first one where not given.
    """
    films = thickness.reshape(-1, *thickness.shape[-2:])
    if len(films) != len(wanted.layers):
        raise ValueError(f"thickness: {len(films)} colours found, allowed: {len(wanted.layers)}, as wanted")
    least = PAINTED_SHARE * film
    covered, spilt, gap, on_wanted, parts = 0, 0, 0.0, [], []
    for number, (layer, laid) in enumerate(zip(wanted.layers, films, strict=True)):
        picture = _at_wanted_cells(laid, grid, wanted)
        painted = picture >= least
        under = picture.ravel()[layer.cells]
        on_wanted.append(under[under >= least])
        covered += len(on_wanted[-1])
        spilt += np.count_nonzero(painted & layer.outside)
        gap += sum(_gaps(line, painted.ravel()[wanted.index(line)]) for line in layer.lines)
        in_hand = down if colour is None else down & (colour == number)
        parts += _stroke_parts(wanted, layer, picture, track(uv_brush, in_hand), least)
    mean, p95 = pooled(parts)
    cells = sum(len(layer.cells) for layer in wanted.layers)
    return PaintScore(
        coverage=float(covered / cells) if cells else 0.0,
        excess=float((spilt * CELL**2 + stray / film) / wanted.area) if cells else 0.0,
        thickness_cv=_variation(np.concatenate(on_wanted)),
        gap_length=gap,
        stroke_error_mean=mean,
        stroke_error_p95=p95,
        stroke_error_judged=wanted.judged,
    )


def score_paint_worlds(
    wanted: Wanted,
    grid: PaintGrid,
    thickness: Float[np.ndarray, "worlds *colours rows columns"],
    uv_brush: Float[np.ndarray, "worlds time 2"],
    down: Bool[np.ndarray, "worlds time"],
    *,
    film: float,
    stray: Float[np.ndarray, "worlds"] | None = None,
    colour: Int[np.ndarray, "worlds time"] | None = None,
) -> list[PaintScore]:
    """`score_paint` for many worlds, on as many threads as there are cores."""
    lost: Sequence[float] = np.zeros(len(thickness)).tolist() if stray is None else np.asarray(stray).tolist()
    # Made once, before threads would make them several times over.
    _ = wanted.area, wanted.judged, [(layer.cells, layer.line_length) for layer in wanted.layers]

    def one(world: int) -> PaintScore:
        swept = uv_brush[world], down[world]
        hand = None if colour is None else colour[world]
        return score_paint(wanted, grid, thickness[world], *swept, film=film, stray=lost[world], colour=hand)

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(one, range(len(thickness))))


def _stroke_parts(wanted: Wanted, layer: Layer, picture: np.ndarray, swept: np.ndarray, least: float):
    found = (
        line_part(layer, wanted.ground, swept),
        edge_part(layer, wanted.ground, picture, least, wanted.radius),
    )
    return [part for part in found if part is not None]


def _at_wanted_cells(thickness: np.ndarray, grid: PaintGrid, wanted: Wanted) -> np.ndarray:
    """The film [m] at the middles of the wanted picture's cells, bilinear."""
    cell, origin = float(grid.cell), np.asarray(grid.origin, float)
    scale, shift = CELL / cell, (wanted.origin - origin) / cell
    to_source = np.array([[scale, 0, shift[0]], [0, scale, shift[1]]])
    rows, columns = wanted.ground.shape
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
