"""When halting S1-(13) is worth it: error, base starts and time against Theta, beside a base that never halts
and one that parks.
"""

import dataclasses
import math

from experiments.reproduce.halting_figure import halting_figure
from experiments.reproduce.result import ReproduceResult, ReproduceSettings, Row
from experiments.reproduce.s1_tracking import HELD_OUT, WORLDS
from experiments.tracking.halting import (
    REACHES,
    THETAS,
    Cell,
    Point,
    halting,
    parking,
    study_for,
)

NAME = "halting"
PICTURES = ("line", "scroll")
"""A simple and an intricate one, both longer than the arm reaches."""
SPEEDS = (0.015, 0.03, 0.06)
"""Of the brush: slow, as in S1, fast [m/s]."""
CHOOSING, CHOOSING_WORLDS = 3_000_000, 64
"""Index of the first world on which Theta and the rival's reach are chosen, and how many."""


@dataclasses.dataclass(frozen=True)
class CellResult:
    """thetas: the point at each Theta. parked: the rival's at its best reach. best: Theta, chosen on other
    worlds [m]; reach likewise [m].
    """

    thetas: dict[float, Point]
    parked: Point
    best: float
    reach: float

    @property
    def rivals(self) -> dict[str, Point]:
        """Those that halting has to beat."""
        return {"without halting": self.thetas[math.inf], "park-operate-park": self.parked}


def run(settings: ReproduceSettings | None = None, worlds: int = WORLDS) -> ReproduceResult:
    """A row of every quantity for each Theta, the rivals, and whether halting beats them (1) or not (0)."""
    seed = (settings or ReproduceSettings()).seed
    cells = [Cell(p, s, looking) for looking in (True, False) for p in PICTURES for s in SPEEDS]
    results = {cell: _measured(cell, seed, worlds) for cell in cells}
    rows = [row for cell, result in results.items() for row in _rows(cell, result)]
    return ReproduceResult.of(rows, {"theta": halting_figure(results)})


def _measured(cell: Cell, seed: int, worlds: int) -> CellResult:
    study = study_for(cell)
    few = min(worlds, CHOOSING_WORLDS)
    finite = [theta for theta in THETAS if math.isfinite(theta)]
    tried = {theta: halting(study, cell, theta, few, CHOOSING) for theta in finite}
    best = min(finite, key=lambda theta: _worth(tried[theta]))
    rivals = {reach: parking(study, cell, reach, few, CHOOSING) for reach in REACHES}
    reach = min(REACHES, key=lambda reach: _worth(rivals[reach]))
    first = HELD_OUT + seed * worlds
    study = study_for(cell, first)
    points = {theta: halting(study, cell, theta, worlds, first) for theta in THETAS}
    return CellResult(points, parking(study, cell, reach, worlds, first), best, reach)


def _worth(point: Point) -> tuple[float, float, float]:
    """Error to a tenth of a millimetre, then time, then starts."""
    return round(point.error[0], 4), point.time[0], point.starts[0]


def _rows(cell: Cell, result: CellResult) -> list[Row]:
    rows = []
    named = {f"theta {theta:g}": point for theta, point in result.thetas.items()}
    named |= {"ours": result.thetas[result.best], "park-operate-park": result.parked}
    for variant, point in named.items():
        for field in dataclasses.fields(point):
            unit = {"error": " [m]", "starts": " [1]", "time": " [s]", "drift": " [m]"}[field.name]
            values = [x if math.isfinite(x) else None for x in getattr(point, field.name)]
            rows.append(Row(f"{field.name}{unit}, {cell}", variant, None, *values))
    rows.append(Row(f"best theta [m], {cell}", "ours", None, result.best))
    for name, rival in result.rivals.items():
        by = result.thetas[result.best].beats(rival)
        what = f"halting beats it by {by}" if by else "halting does not beat it"
        rows.append(Row(f"{what} [1], {cell}", name, None, float(bool(by))))
    return rows
