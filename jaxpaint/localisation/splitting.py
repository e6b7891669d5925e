"""Runs of echoes, one after the other on the same surface, cut where neither a line nor an arc fits.

A cut is made where it explains the ranges better than noise could: by chi-squared and not by a distance, so
that long walls stay whole and shallow bends of long runs are seen.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from jaxpaint.localisation.arc_fit import ArcFit, fit_arc
from jaxpaint.localisation.line_fit import LineFit, fit_line

FEWEST = 6
"""Echoes of a piece."""
# What a cut explains beyond this is no noise: twice the logarithm of some hundred places, and 3 deviations.
_EXPLAINED = 25.0
# An arc may leave this much more than two lines and is still taken: it has a parameter less [chi-squared].
_ALIKE = 4.0
# Neighbouring echoes belong together up to this angle between the surface and the beams [rad] ...
_SLANTED = 0.14
# ... with this many deviations of the noise beside, and with no more beams than this missing between [-].
_NOISE = 5.0
_MISSING = 6.0
# Beams nearer to a line's direction count as if they were not: a guess of the line may be far off [-].
_LEAST_SQUARELY = 0.1


def runs_of(points: Float[np.ndarray, "beams 2"], sigma: float) -> list[Float[np.ndarray, "m 2"]]:
    """Echoes relative to the scanner, in the order of the beams and NaN for none, parted at jumps.

    Between neighbours on one surface the gap grows with the range, and with the slant. sigma: of a range [m].
    """
    known = points[np.isfinite(points).all(-1)]
    known = known[np.linalg.norm(known, axis=1) > 0]
    if len(known) < 2:
        return []
    ranges, heading = np.linalg.norm(known, axis=1), np.unwrap(np.arctan2(known[:, 1], known[:, 0]))
    step, gap = np.abs(np.diff(heading)), np.linalg.norm(np.diff(known, axis=0), axis=1)
    near = np.minimum(ranges[1:], ranges[:-1])
    apart = gap > near * step / np.sin(_SLANTED) + _NOISE * sigma
    apart |= step > _MISSING * np.median(step)
    return np.split(known, np.flatnonzero(apart) + 1)


def segments_of(run: Float[np.ndarray, "m 2"], sigma: float) -> list[LineFit | ArcFit]:
    """Lines and arcs through one run, in its order. Left out are stretches of few echoes, and what neither
    fits: no wall but a plant, or people.
    """
    segments = _segments(run, 0, len(run), sigma)
    for width in (3, 2):
        segments = _joined(width, run, segments, sigma)
    parts = [(run[s.begin : s.end], s.curved) for s in segments if s.end - s.begin >= FEWEST]
    fits = [fit_arc(part) if curved else fit_line(part) for part, curved in parts]
    return [fit for fit in fits if fit is not None and _is_plain(fit, sigma)]


class _Segment(NamedTuple):
    begin: int
    end: int
    curved: bool


def _segments(run, begin: int, end: int, sigma: float) -> list[_Segment]:
    """A stretch of a run, cut in two until lines or arcs fit."""
    part = run[begin:end]
    if len(part) < 2 * FEWEST:
        return [_Segment(begin, end, False)]
    line = fit_line(part)
    place, explained = _best_cut(part, line, sigma)
    if explained < _EXPLAINED:
        return [_Segment(begin, end, False)]
    arc = fit_arc(part)
    if arc and _is_plain(arc, sigma) and _misfit(arc, sigma) < _misfit(line, sigma) - explained + _ALIKE:
        return [_Segment(begin, end, True)]
    return _segments(run, begin, begin + place, sigma) + _segments(run, begin + place, end, sigma)


def _joined(width: int, run, segments: list[_Segment], sigma: float) -> list[_Segment]:
    """The segments, each `width` straight neighbours made one fewer where that does.

    Cutting in two again and again misses corners by some echoes, which then make a segment of their own.
    With a width of 2 a cut is moved to where it explains most, or left out where that is nothing.
    """
    done, ahead = [], list(segments)
    while len(ahead) >= width:
        if not any(segment.curved for segment in ahead[:width]):
            fewer = _fewer(run, ahead[:width], sigma)
            ahead = fewer + ahead[width:]
            if len(fewer) < width:
                continue
        done.append(ahead.pop(0))
    return done + ahead


def _fewer(run, segments: list[_Segment], sigma: float) -> list[_Segment]:
    begin, end = segments[0].begin, segments[-1].end
    both = run[begin:end]
    place, explained = _best_cut(both, fit_line(both), sigma)
    two = [_Segment(begin, begin + place, False), _Segment(begin + place, end, False)]
    if len(segments) == 2:
        return two if explained >= _EXPLAINED else [_Segment(begin, end, False)]
    now, then = (
        sum(_misfit(fit_line(run[s.begin : s.end]), sigma) for s in pieces) for pieces in (segments, two)
    )
    return two if then - now < _EXPLAINED else segments


def _misfit(fit: LineFit | ArcFit, sigma: float) -> float:
    return float(((fit.off / sigma) ** 2).sum())


def _is_plain(fit: LineFit | ArcFit, sigma: float) -> bool:
    """Whether noise alone may leave so much."""
    return _misfit(fit, sigma) < len(fit.off) + 4 * np.sqrt(2 * len(fit.off))


def _best_cut(run, fit: LineFit, sigma: float) -> tuple[int, float]:
    """The cut into two lines that leaves least, and how much less it leaves than one line [chi-squared]."""
    weight = 1 / (np.maximum(fit.squarely, _LEAST_SQUARELY) * sigma) ** 2
    left, right = _scatters(run, weight), _scatters(run[::-1], weight[::-1])[::-1]
    places = np.arange(FEWEST, len(run) - FEWEST + 1)
    both = left[places - 1] + right[places]
    best = int(np.argmin(both))
    return int(places[best]), float(left[-1] - both[best])


def _scatters(points, weight):
    """For each k, the least weighed sum of squared distances of the first k + 1 points from any line."""
    x, y = (points - points.mean(0)).T
    n, sx, sy, xx, xy, yy = np.cumsum(weight * np.stack([np.ones_like(x), x, y, x * x, x * y, y * y]), axis=1)
    a, b, c = xx - sx * sx / n, xy - sx * sy / n, yy - sy * sy / n
    return np.maximum((a + c) / 2 - np.hypot((a - c) / 2, b), 0)
