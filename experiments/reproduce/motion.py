"""The trajectory controller's planner on random missions: limits, jumps, clearance, time over the bound."""

import dataclasses

import numpy as np
from matplotlib.figure import Figure

from experiments.motion import Checked, check, random_missions
from experiments.report.style import INK, PAINT, look, new_figure
from experiments.reproduce.result import ReproduceResult, ReproduceSettings, Row
from sims.scenes import WALLS

NAME = "motion"
MISSIONS = 200
"""Shared out among the walls."""
LIMIT = 1.15
"""Motion time over the least time that is asked for at most [1]."""


@dataclasses.dataclass(frozen=True, eq=False)
class WallMissions:
    """One wall's: the missions that were driven, how many the planner refused, and the share of drawn targets
    that were no fair ones.
    """

    wall: str
    checked: list[Checked]
    refused: int
    redrawn: float


def run(
    settings: ReproduceSettings | None = None, missions: int = MISSIONS, walls: tuple[str, ...] = tuple(WALLS)
) -> ReproduceResult:
    """The figures of each wall and of all together; the papers publish none."""
    seed = (settings or ReproduceSettings()).seed
    counts = [missions // len(walls) + (k < missions % len(walls)) for k in range(len(walls))]
    done = [drive(wall, count, seed) for wall, count in zip(walls, counts, strict=True)]
    rows = [row for one in done for row in rows_of(one)]
    together = WallMissions(
        "all",
        [each for one in done for each in one.checked],
        sum(one.refused for one in done),
        float(np.average([one.redrawn for one in done], weights=counts)),
    )
    return ReproduceResult.of([*rows_of(together), *rows], {"time over the bound": _figure(done)})


def drive(wall: str, count: int, seed: int) -> WallMissions:
    """Plans and checks `count` missions before one wall."""
    missions = random_missions(wall, count, seed=seed)
    return WallMissions(wall, check(missions), int(missions.refused.sum()), missions.redrawn)


def rows_of(one: WallMissions) -> list[Row]:
    """What the missions of a wall came to; null where none was driven."""
    nothing: dict[str, float | None] = dict.fromkeys(DRIVEN)
    figures: dict[str, float | None] = {
        "missions driven": float(len(one.checked)),
        "missions refused, no clear way known": float(one.refused),
        "targets drawn anew, no fair ones [1]": one.redrawn,
    }
    figures |= _driven(one.checked) if one.checked else nothing
    return [Row(f"{what}, {one.wall}", "ours", None, value) for what, value in figures.items()]


DRIVEN = (
    "missions that touch",
    "largest share of a speed limit [1]",
    "largest share of an acceleration limit [1]",
    "largest share of a torque limit [1]",
    "largest jump of acceleration in 1 ms, base's place [m/s^2]",
    "largest jump of acceleration in 1 ms, base's yaw [rad/s^2]",
    "largest jump of acceleration in 1 ms, arm [rad/s^2]",
    "least distance of the body to what is around [m]",
    "least distance of the brush to what is around [m]",
    "least distance of the robot to itself [m]",
    "time in motion over its bound, mean [1]",
    "time in motion over its bound, worst [1]",
    "time in motion over the bound without wheels, worst [1]",
    "rest at via points, mean [s]",
)


def _driven(checked: list[Checked]) -> dict[str, float]:
    distance = np.array([one.distance for one in checked]).min(0)
    ratio = np.array([one.moving / one.bound for one in checked])
    bare = np.array([one.moving / (one.bound - one.turning) for one in checked])
    values = (
        sum(one.collides for one in checked),
        *(max(getattr(one, name) for one in checked) for name in ("speed", "acceleration", "torque")),
        *np.array([one.jump for one in checked]).max(0),
        *np.where(np.isfinite(distance), distance, np.nan),
        ratio.mean(),
        ratio.max(),
        bare.max(),
        np.mean([one.via_rest for one in checked]),
    )
    return {name: float(value) for name, value in zip(DRIVEN, values, strict=True)}


def _figure(done: list[WallMissions]) -> Figure:
    """How much longer each mission takes than the least time, and the limit."""
    with look():
        figure = new_figure(3.2)
        axis = figure.subplots()
        for row, one in enumerate(done):
            ratio = [each.moving / each.bound for each in one.checked]
            axis.scatter(ratio, np.full(len(ratio), row), color=PAINT, alpha=0.5, s=18, linewidths=0)
        axis.axvline(LIMIT, color=INK, linestyle="--", linewidth=1)
        axis.set_yticks(range(len(done)), [one.wall for one in done])
        axis.set_xlim(0.99, 1.2)
        axis.set_xlabel("time in motion over the least time of the same path")
    return figure
