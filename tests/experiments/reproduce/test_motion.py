"""The mission figures: a row for each quantity and wall, within what is asked for."""

import pytest

from experiments.reproduce.motion import DRIVEN, WallMissions, rows_of, run


def test_a_wall_without_a_mission_that_is_driven_has_no_figures():
    rows = rows_of(WallMissions("flat", [], 3, 0.25))
    values = {row.name.rpartition(", ")[0]: row.ours for row in rows}
    assert values["missions refused, no clear way known"] == 3 and values["missions driven"] == 0
    assert all(values[name] is None for name in DRIVEN)


@pytest.mark.slow
def test_four_missions():
    result = run(missions=4, walls=("corner",))
    table = {str(row["name"]): row["ours"] for row in result.table}
    for wall in ("all", "corner"):
        assert table[f"missions driven, {wall}"] + table[f"missions refused, no clear way known, {wall}"] == 4
        assert table[f"missions driven, {wall}"] >= 3
        assert table[f"missions that touch, {wall}"] == 0
        for limit in ("a speed", "an acceleration", "a torque"):
            assert 0 < table[f"largest share of {limit} limit [1], {wall}"] <= 1.001
        assert 1 < table[f"time in motion over its bound, worst [1], {wall}"] <= 1.15
    assert list(result.figures) == ["time over the bound"]
