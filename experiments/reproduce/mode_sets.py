"""Labelled lists of poses for mode detection: scan waypoints, and strokes of a drawing, on S1's three walls.

Each list is drawn from its own seed, so that development and held-out lists never meet.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

MOST = 2048
"""Room for the longest list."""
_WALLS = ("flat", "corner", "cylinder")
_LETTERS = {
    "A": (((0, 0), (0.5, 1), (1, 0)), ((0.2, 0.4), (0.8, 0.4))),
    "E": (((1, 0), (0, 0), (0, 1), (1, 1)), ((0, 0.5), (0.8, 0.5))),
    "K": (((0, 0), (0, 1)), ((1, 1), (0, 0.45), (1, 0))),
    "M": (((0, 0), (0, 1), (0.5, 0.4), (1, 1), (1, 0)),),
    "R": (((0, 0), (0, 1), (0.7, 1), (1, 0.75), (0.7, 0.5), (0, 0.5)), ((0.5, 0.5), (1, 0))),
    "S": (((1, 0.85), (0.5, 1), (0, 0.8), (0.2, 0.55), (0.8, 0.45), (1, 0.2), (0.5, 0), (0, 0.15)),),
    "T": (((0, 1), (1, 1)), ((0.5, 1), (0.5, 0))),
    "Z": (((0, 1), (1, 1), (0, 0), (1, 0)),),
}


@dataclass(frozen=True)
class PoseList:
    """Poses in their order, in the map frame [m], and what they are.

    is_path: strokes, against scan waypoints. kind: for people.
    """

    position: Float[np.ndarray, "n 3"]
    rotation: Float[np.ndarray, "n 3 3"]
    is_path: bool
    kind: str


def draw_list(seed: int) -> PoseList:
    """One list; even seeds give waypoints, odd ones strokes."""
    rng = np.random.default_rng(seed)
    return _strokes(rng) if seed % 2 else _waypoints(rng)


def _waypoints(rng: np.random.Generator) -> PoseList:
    """Camera poses on a jittered grid that faces a wall, 3 to 40 of them, in rows, in columns or in any
    order.

    A third of the lists are single rows or columns, as a planner makes them for a canvas one picture high.
    """
    place, wall = _wall(rng)
    single = rng.random() < 1 / 3
    while True:
        rows, columns = (1, int(rng.integers(3, 13))) if single else rng.integers(1, 13, 2)
        if 3 <= rows * columns <= 40:
            break
    if single and rng.random() < 0.3:
        rows, columns = columns, rows
    step = rng.uniform((0.2, 0.15), (1.2, 0.6))
    u, v = np.meshgrid(np.arange(columns) - (columns - 1) / 2, np.arange(rows) - (rows - 1) / 2)
    turn = rng.integers(3)
    if turn == 1:
        u[1::2] = u[1::2, ::-1]
    uv = np.stack([u * step[0], v * step[1]], -1)
    uv = (uv.swapaxes(0, 1) if turn == 2 else uv).reshape(-1, 2)
    uv = rng.permutation(uv) if rng.random() < 0.2 else uv
    jitter = rng.uniform(0, 0.05)
    uv = uv + jitter * rng.standard_normal(uv.shape)
    distance = rng.uniform(0.5, 1.1) + jitter * rng.standard_normal(len(uv))
    position, rotation = place(uv, distance)
    rotation = _shaken(rotation, rng.uniform(0, 0.1), rng)
    return PoseList(position, rotation, False, f"{rows} x {columns} views, {wall}")


def _strokes(rng: np.random.Generator) -> PoseList:
    """Brush poses along one shape or a drawing of several, 50 to 2,000 of them."""
    place, wall = _wall(rng)
    kind = str(rng.choice(list(_SHAPES)))
    lines = _SHAPES[kind](rng)
    step = rng.uniform(0.001, 0.02)
    uv = np.concatenate([_resampled(line, step) for line in lines])
    number = int(np.clip(len(uv), 50, 2000))
    if number != len(uv):
        length = sum(np.linalg.norm(np.diff(line, axis=0), axis=1).sum() for line in lines)
        uv = np.concatenate([_resampled(line, length / (number + 2 * len(lines))) for line in lines])[:2000]
    position, rotation = place(uv, rng.uniform(0, 0.001) * rng.standard_normal(len(uv)))
    rotation = _shaken(rotation, rng.uniform(0, 0.03), rng)
    return PoseList(position, rotation, True, f"{kind}, {wall}")


def _line(rng: np.random.Generator) -> list[np.ndarray]:
    angle, length = rng.uniform(0, np.pi), rng.uniform(0.1, 2.4)
    return [np.linspace(-0.5, 0.5, 2)[:, None] * length * np.array([np.cos(angle), np.sin(angle) / 3])]


def _curve(rng: np.random.Generator) -> list[np.ndarray]:
    x = np.linspace(-1, 1, 800)
    waves = sum(rng.normal(0, 0.3 / k) * np.sin(k * np.pi * x + rng.uniform(0, 6)) for k in range(1, 5))
    return [rng.uniform(0.1, 1.2) * np.stack([x, waves], -1)]


def _circle(rng: np.random.Generator) -> list[np.ndarray]:
    angle = np.linspace(0, 2 * np.pi * rng.uniform(0.5, 1), 800)
    radius = rng.uniform(0.03, 0.5) * np.array([1, rng.uniform(0.4, 1)])
    return [np.stack([np.cos(angle), np.sin(angle)], -1) * radius]


def _letters(rng: np.random.Generator) -> list[np.ndarray]:
    size, word = rng.uniform(0.05, 0.4), rng.choice(list(_LETTERS), rng.integers(1, 7))
    starts = np.arange(len(word)) - len(word) / 2
    return [
        size * np.add(line, (1.3 * start, -0.5))
        for letter, start in zip(word, starts, strict=True)
        for line in _LETTERS[str(letter)]
    ]


def _hatch(rng: np.random.Generator) -> list[np.ndarray]:
    pitch, width = rng.uniform(0.01, 0.03), rng.uniform(0.1, 0.5)
    rows = pitch * np.arange(rng.integers(4, 20))
    return [np.array([(-width / 2, v), (width / 2, v)][:: 1 if k % 2 else -1]) for k, v in enumerate(rows)]


def _drawing(rng: np.random.Generator) -> list[np.ndarray]:
    lines = [
        line for _ in range(rng.integers(3, 10)) for line in (_line, _curve, _circle)[rng.integers(3)](rng)
    ]
    return [0.3 * line + rng.uniform((-1, -0.3), (1, 0.3)) for line in lines]


_SHAPES: dict[str, Callable[[np.random.Generator], list[np.ndarray]]] = {
    "line": _line,
    "curve": _curve,
    "circle": _circle,
    "letters": _letters,
    "hatch": _hatch,
    "drawing": _drawing,
}


def _wall(rng: np.random.Generator):
    """A function from arc length, height and stand-off [m] to poses that face a wall, and the wall's name."""
    wall = str(rng.choice(_WALLS))
    radius, lean = rng.uniform(0.8, 2.5), rng.uniform(-0.4, 0.4)

    def place(uv, height):
        u, v = uv.T
        if wall == "cylinder":
            heading = u / radius
            p = np.stack([radius * (1 - np.cos(heading)), -radius * np.sin(heading)], -1)
        else:
            heading = np.where(u < 0, np.pi / 4, -np.pi / 4) if wall == "corner" else np.full_like(u, lean)
            p = u[:, None] * np.stack([np.sin(heading), -np.cos(heading)], -1)
        ahead = np.stack([np.cos(heading), np.sin(heading)], -1)
        p = p - np.broadcast_to(height, u.shape)[:, None] * ahead
        z = np.concatenate([ahead, np.zeros((len(u), 1))], -1)
        x = np.stack([z[:, 1], -z[:, 0], z[:, 2]], -1)
        return np.concatenate([p, 1.2 + v[:, None]], -1), np.stack([x, np.cross(z, x), z], -1)

    return place, wall


def _shaken(rotation: np.ndarray, angle: float, rng: np.random.Generator) -> np.ndarray:
    """Each rotation turned a little about an axis of its own (Rodrigues)."""
    vector = angle * rng.standard_normal((len(rotation), 3))
    size = np.linalg.norm(vector, axis=1)[:, None, None] + 1e-12
    x, y, z = vector.T
    skew = np.stack([0 * x, -z, y, z, 0 * x, -x, -y, x, 0 * x], -1).reshape(-1, 3, 3)
    turn = np.eye(3) + np.sin(size) / size * skew + (1 - np.cos(size)) / size**2 * skew @ skew
    return rotation @ turn


def _resampled(line: np.ndarray, step: float) -> np.ndarray:
    """Points along a line at even steps close to `step` [m], its ends included."""
    place = np.append(0, np.linalg.norm(np.diff(line, axis=0), axis=1).cumsum())
    at = np.linspace(0, place[-1], max(2, round(place[-1] / step) + 1))
    return np.stack([np.interp(at, place, line[:, k]) for k in (0, 1)], -1)
