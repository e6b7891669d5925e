"""The halting study: what counts as better, how starts are counted, and both rivals on a short line."""

import math

import numpy as np
import pytest

from experiments.reproduce.halting import CellResult, _rows
from experiments.reproduce.halting_figure import halting_figure
from experiments.tracking.follow import base_starts
from experiments.tracking.halting import THETAS, Cell, Point, halting, parking
from experiments.tracking.study import study_of
from sims.rollout import Record

WORLDS = 8


def _point(error=(1.0, 0.9, 1.1), time=(80.0, 80.0, 80.0)) -> Point:
    return Point(error, (3.0, 3.0, 3.0), time, (20.0, 15.0, 25.0))


@pytest.mark.parametrize(
    ("ours", "rival", "by"),
    [
        (_point((1.0, 0.9, 1.1)), _point((1.3, 1.2, 1.4)), "error"),
        (_point((1.0, 0.9, 1.1)), _point((1.1, 1.0, 1.2)), ""),
        (_point((1.0, 0.9, 1.1)), _point((1.0, 0.9, 1.1), (90.0, 89.0, 91.0)), "time"),
        (_point((1.0, 0.9, 1.1)), _point((0.5, 0.4, 0.6), (90.0, 89.0, 91.0)), ""),
        (_point((1.0, 0.9, 1.1), (90.0, 89.0, 91.0)), _point(), ""),
        (_point((math.inf,) * 3), _point(), ""),
    ],
)
def test_better_is_certainly_better(ours, rival, by):
    assert ours.beats(rival) == by


def test_starts_are_those_after_a_rest():
    """Two worlds at 80 ms a record: one sets off twice, one only trembles."""
    way = np.zeros((2, 60, 3))
    for first, last in ((10, 20), (22, 30), (40, 50)):  # the pause of 160 ms is no rest
        way[0, first:last, 0] = 0.002
    way[1, :, 0] = 0.0003
    base = np.cumsum(way, axis=1)
    live = np.ones((2, 60), bool)
    record = Record(*([base] * len(Record._fields)))._replace(live=live)
    np.testing.assert_array_equal(base_starts(record, 0.02), [2, 0])
    assert (base_starts(record._replace(live=~live), 0.02) == 0).all()


@pytest.fixture(scope="module")
def study():
    """A line of 1.3 m without noise."""
    u = np.linspace(-0.65, 0.65, 500)
    return study_of(np.stack([u, 0 * u], axis=1), noise="none")


@pytest.mark.slow
def test_a_held_base_starts_less_often_and_a_parked_one_costs_time(study):
    cell = Cell("line", 0.03, looking=False)
    held, never = (halting(study, cell, theta, WORLDS, 0) for theta in (0.4, math.inf))
    parked = parking(study, cell, 0.24, WORLDS, 0)
    assert held.starts[0] < never.starts[0]
    assert held.time[0] == pytest.approx(never.time[0], rel=0.01)
    assert parked.time[0] > held.time[0] + 5
    assert max(p.error[0] for p in (held, never, parked)) < 1e-3


def test_rows_and_picture_have_every_cell():
    thetas = {theta: _point((1 + theta if theta < 9 else 3.0,) * 3) for theta in THETAS}
    result = CellResult(thetas, _point((math.inf,) * 3), best=0.2, reach=0.4)
    cells = {
        Cell(p, s, looking): result for p in ("line", "scroll") for s in (0.03, 0.06) for looking in (0, 1)
    }
    rows = [row for cell, result in cells.items() for row in _rows(cell, result)]
    named = {(row.name, row.variant): row.ours for row in rows}
    cell = "line, 30 mm/s, looking"
    assert named[f"error [m], {cell}", "ours"] == named[f"error [m], {cell}", "theta 0.2"] == 1.2
    assert named[f"error [m], {cell}", "theta inf"] == 3.0
    assert named[f"error [m], {cell}", "park-operate-park"] is None  # none came to its end
    assert named[f"halting beats it by error [1], {cell}", "without halting"] == 1.0
    assert named[f"best theta [m], {cell}", "ours"] == 0.2
    assert len({(row.name, row.variant) for row in rows}) == len(rows)
    assert len(halting_figure(cells).axes) == 12
