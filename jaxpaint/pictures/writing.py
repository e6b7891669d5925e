"""The order of writing, for a robot that reaches only part of the wall at once: column by column."""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from jaxpaint.pictures.drawing import Polyline, is_closed, polyline_length
from jaxpaint.pictures.routes import greedy_route, painted, shortened

WIDTH = 0.36
"""Of a column at most [m]: what the reference robot's arm reaches in comfort from a parked base. Another arm
wants another width: `plan_strokes` takes it as `column`."""

REACH = 0.19
"""How far to either side of a parked base the reference robot's arm paints [m]. It only chooses between two
orders, so another arm's paints no worse, at most with more driving."""

_SHORTEST = 0.1  # [m]: a shorter part of a line stays with the column that it comes from


@dataclass(frozen=True)
class Columns:
    """Columns of equal width side by side [m], the first one's left side at `left`."""

    left: float
    width: float
    count: int

    def at(self, u: np.ndarray) -> np.ndarray:
        """The column of each place."""
        return np.clip(np.floor((u - self.left) / self.width), 0, self.count - 1).astype(int)


def columns(lines: list[Polyline], width: float) -> Columns:
    """The fewest columns no wider than asked for that share the width of all lines evenly."""
    u = np.concatenate(lines)[:, 0]
    left, extent = float(u.min()), float(np.ptp(u))
    count = max(1, math.ceil(extent / width - 1e-9))
    return Columns(left, max(extent, 1e-9) / count, count)


def cut(line: Polyline, among: Columns) -> list[Polyline]:
    """A line in parts that belong to one column each; parts shorter than 0.1 m stay with the one before."""
    u = line[:, 0]
    if among.count == 1 or len(set(among.at(np.array([u.min(), u.max()])))) == 1:
        return [line]
    points = _crossed(line, among)
    column = among.at((points[1:, 0] + points[:-1, 0]) / 2)
    starts = np.concatenate([[0], np.flatnonzero(np.diff(column)) + 1, [len(column)]])
    parts = [points[a : b + 1] for a, b in pairwise(starts)]
    if is_closed(line) and len(parts) > 1 and column[0] == column[-1]:
        parts[0] = np.concatenate([parts.pop()[:-1], parts[0]])
    return _without_short(parts)


def in_columns(lines: list[Polyline], parts: list[Polyline], among: Columns) -> list[Polyline]:
    """Lines and parts of lines column by column from the left, in each from the top left with little travel.

    A line belongs where it begins on the left, a part where most of it lies.
    """
    begin = [float(line[:, 0].min()) + 1e-9 for line in lines]
    column = among.at(np.array(begin + [_middle(part) for part in parts]))
    lines = lines + parts
    ordered: list[Polyline] = []
    for k in range(among.count):
        block = [line for line, at in zip(lines, column, strict=True) if at == k]
        if block:
            points = np.concatenate(block)
            corner = np.array([points[:, 0].min(), points[:, 1].max()])
            ordered += painted(block, shortened(block, greedy_route(block, corner)))
    return ordered


def base_travel(lines: list[Polyline], reach: float = REACH) -> float:
    """How far a base must drive along u at least to keep the brush within reach, line after line."""
    base, driven = float(lines[0][0, 0]), 0.0
    for line in lines:
        # Between its turning points a line pulls the base one way only.
        u = line[:, 0]
        turns = np.flatnonzero(np.diff(np.sign(np.diff(u)))) + 1
        for at in u[np.concatenate([[0], turns, [len(u) - 1]])]:
            after = min(max(base, float(at) - reach), float(at) + reach)
            driven, base = driven + abs(after - base), after
    return driven


def _crossed(line: Polyline, among: Columns) -> Polyline:
    """A line with points where it passes from column to column."""
    borders = among.left + among.width * np.arange(1, among.count)
    points = [line[:1]]
    for a, b in pairwise(line):
        if a[0] != b[0]:
            t = (borders - a[0]) / (b[0] - a[0])
            points.append(a + np.sort(t[(t > 1e-9) & (t < 1 - 1e-9)])[:, None] * (b - a))
        points.append(b[None])
    return np.concatenate(points)


def _middle(line: Polyline) -> float:
    """The mean of u along a line."""
    steps = np.linalg.norm(np.diff(line, axis=0), axis=1)
    return float(((line[1:, 0] + line[:-1, 0]) / 2) @ steps / steps.sum())


def _without_short(parts: list[Polyline]) -> list[Polyline]:
    """Parts in their order, the short ones joined to the one before, the first one to the one after."""
    joined: list[Polyline] = []
    for part in parts:
        short = polyline_length(part) < _SHORTEST or (joined and polyline_length(joined[-1]) < _SHORTEST)
        if joined and short and (joined[-1][-1] == part[0]).all():
            joined[-1] = np.concatenate([joined[-1], part[1:]])
        else:
            joined.append(part)
    return joined
