"""S1 figure 11: a curve mapped onto a flat wall, a corner and a cylinder, and the brush's directions."""

import dataclasses
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
from matplotlib.figure import Figure

from experiments.report.style import PAINT, SOFT, TRAVEL, look, new_figure
from experiments.reproduce.result import ReproduceResult, ReproduceSettings, Row
from jaxpaint.mapping import Canvas, Cause, Mapped, cast
from jaxpaint.mapping.raycast import Metric
from sims.scenes.canvases import default_canvas
from sims.scenes.scene import Scene
from sims.scenes.walls import make_wall

NAME = "s1-figure-11"
SPACING = 0.010
"""Of the noiseless cloud, along the surface [m]."""
POINTS = 400
_ROOM = 2**15
"""Points that each cloud is padded to: one program for all walls."""
_MARGIN = 0.12
"""Of the cloud around the canvas [m]."""
_WALLS = ("flat", "corner", "cylinder")
_METRICS: dict[str, Metric] = {"ours": "distance", "cosine metric": "cosine"}
_ARROW = 0.12
"""Length of the drawn brush directions [m]."""


@dataclasses.dataclass(frozen=True)
class MappedWall:
    """One wall of the figure: where the curve landed, how far from the true surface, and how far it leans."""

    name: str
    cloud: np.ndarray
    mapped: Mapped
    distance: np.ndarray
    lean: np.ndarray


def run(
    settings: ReproduceSettings | None = None, variants: tuple[str, ...] = tuple(_METRICS)
) -> ReproduceResult:
    """Largest errors over all hits, by our metric and by S1's cosine; the figure shows ours. Not random."""
    del settings
    rows, shown = [], []
    for name in _WALLS:
        for variant in variants:
            wall = map_curve(name, _METRICS[variant])
            hit = np.asarray(wall.mapped.status) == Cause.HIT
            figures = {
                "largest distance of a hit from the surface [m]": wall.distance[hit].max(),
                "largest lean of the brush from the normal [deg]": np.degrees(wall.lean[hit].max()),
                "rays left out [1]": np.mean(~hit),
            }
            rows += [Row(f"{what}, {name}", variant, None, float(value)) for what, value in figures.items()]
            shown += [wall] if variant == "ours" else []
    return ReproduceResult.of(rows, {"trajectories": _figure(shown)})


def map_curve(kind: str, metric: Metric = "distance") -> MappedWall:
    """The curve on one wall, from a cloud without noise."""
    scene = make_wall(kind)
    canvas = default_canvas(scene)
    cloud = sampled(scene, canvas, SPACING)
    room = np.full((_ROOM - len(cloud), 3), np.nan)
    uv = jnp.asarray(_curve(POINTS)) * canvas.size
    padded = jnp.asarray(np.concatenate([cloud, room]))
    mapped = _cast(uv, canvas, padded, jnp.arange(_ROOM) < len(cloud), metric=metric)
    at, height = jax.jit(jax.vmap(scene.chart.to_uv))(mapped.p_map)
    cosine = np.sum(np.asarray(jax.vmap(scene.chart.normal)(at)) * np.asarray(mapped.normal), axis=-1)
    lean = np.arccos(np.clip(cosine.astype(float), -1, 1))
    return MappedWall(kind, cloud, mapped, np.abs(np.asarray(height)), lean)


@partial(jax.jit, static_argnames="metric")
def _cast(uv, canvas: Canvas, cloud, valid, *, metric: Metric) -> Mapped:
    return cast(uv, canvas, cloud, valid, metric=metric)


def sampled(scene: Scene, canvas: Canvas, spacing: float) -> np.ndarray:
    """Points of the true surface before the canvas, on a square grid of its own coordinates [m]."""
    lower, upper = np.asarray(scene.chart.lower, float), np.asarray(scene.chart.upper, float)
    u, v = (np.arange(low, high, spacing) for low, high in zip(lower, upper, strict=True))
    grid = np.stack(np.meshgrid(u, v), -1).reshape(-1, 2)
    cloud = jax.jit(jax.vmap(scene.chart.point))(jnp.asarray(grid))
    across, _ = canvas.to_canvas(cloud)
    return np.asarray(cloud)[np.asarray((jnp.abs(across) <= canvas.size / 2 + _MARGIN).all(-1))]


def _curve(number: int) -> np.ndarray:
    """A wave over most of a canvas of size one."""
    x = np.linspace(-0.46, 0.46, number)
    return np.stack([x, 0.38 * np.sin(7.5 * x) * np.cos(2 * x)], -1)


def _figure(walls: list[MappedWall]) -> Figure:
    """Side view (the robot's right against up) above, top view below."""
    with look():
        figure = new_figure(4.2, 12.0)
        axes = figure.subplots(2, len(walls), height_ratios=(1, 1.4), sharex=True, sharey="row")
        for column, wall in zip(axes.T, walls, strict=True):
            _view(column[0], wall, _seen_from_the_robot)
            _view(column[1], wall, _seen_from_above)
            column[0].set_title(wall.name)
            column[1].set_xlabel("to the right [m]")
        axes[0, 0].set(ylabel="up [m]")
        axes[1, 0].set(ylabel="ahead [m]")
        axes[1, 0].legend(loc="upper left", fontsize=8)
    return figure


def _view(axis, wall: MappedWall, seen) -> None:
    hit = np.asarray(wall.mapped.status) == Cause.HIT
    points, normals = np.asarray(wall.mapped.p_map), np.asarray(wall.mapped.normal)
    axis.plot(*seen(wall.cloud[::7]), ",", color=SOFT, alpha=0.5, zorder=1)
    curve = np.where(hit[:, None], points, np.nan)
    axis.plot(*seen(curve), color=PAINT, zorder=3, label="path")
    # the brush comes from the robot's side: its direction ends on the surface
    some = np.flatnonzero(hit)[:: max(1, hit.sum() // 30)]
    start = points[some] + _ARROW * normals[some]
    axis.quiver(
        *seen(start), *seen(points[some] - start), color=TRAVEL, angles="xy", scale_units="xy", scale=1,
        width=0.004, zorder=4, label="brush direction",
    )  # fmt: skip
    axis.set_aspect("equal")


def _seen_from_the_robot(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return -points[:, 1], points[:, 2]


def _seen_from_above(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return -points[:, 1], points[:, 0]
