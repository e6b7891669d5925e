"""Tables I and III: the rows that scripts read, worlds that fail, and, slowly, the bars themselves."""

import numpy as np
import pytest

from experiments.reproduce.s1_table_1 import TABLE as TABLE_1
from experiments.reproduce.s1_table_3 import TABLE as TABLE_3
from experiments.reproduce.s1_tracking import _rows, run_table
from experiments.tracking import Followed
from sims.scoring import Tally, tracking_score


def followed(total, completed) -> Followed:
    """Worlds with these errors [m], all along y."""
    worlds = len(total)
    blank = tracking_score(Tally.zero(float))
    score = type(blank)(**{name: np.zeros(worlds) for name in vars(blank)})
    object.__setattr__(score, "total", np.asarray(total))
    object.__setattr__(score, "rmse", np.stack([np.zeros(worlds), total, np.zeros(worlds)], axis=1))
    way = np.zeros((worlds, 2, 3))
    return Followed(score, np.asarray(completed), np.ones(worlds), np.ones(worlds), way, way, way[..., 0] > 1)


def test_rows_are_those_of_the_contract():
    rows = {row.name: row for row in _rows(TABLE_1, "ours", followed([0.001, 0.002, 0.003], [True] * 3))}
    assert {"x", "y", "z", "total", "odometry drift, largest [m]", "base travel [m]"} <= set(rows)
    assert rows["total"].published == 0.024 and rows["x"].published is None
    assert rows["total"].ours == rows["y"].ours == 0.002
    assert rows["worlds at the end [1]"].ours == 1


def test_a_world_that_fails_is_infinitely_far_off_in_every_row():
    rows = {r.name: r for r in _rows(TABLE_3, "ours", followed([0.001, 0.001, 0.001], [True, False, False]))}
    assert [rows[name].ours for name in ("x", "y", "z", "total")] == [None] * 4
    assert rows["worlds at the end [1]"].ours == pytest.approx(1 / 3)


@pytest.mark.slow
@pytest.mark.parametrize(("table", "bar"), [(TABLE_1, 0.005), (TABLE_3, 0.012)])
def test_the_printed_controller_errs_as_published_and_ours_does_not(table, bar):
    found = run_table(table, seed=0, dynamic=False).table
    total = {row["variant"]: row["ours"] for row in found if row["name"] == "total"}
    assert total["literal"] == pytest.approx(table.published, rel=0.15)
    assert total["ours"] <= bar
