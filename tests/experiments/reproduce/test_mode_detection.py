import numpy as np
import pytest

from experiments.reproduce import REPRODUCTIONS, load
from experiments.reproduce.mode_detection import VARIANTS, run, wilson
from experiments.reproduce.mode_sets import MOST, draw_list


def test_the_registry_finds_its_modules():
    for name in REPRODUCTIONS:
        module = load(name)
        assert name == module.NAME and callable(module.run)


@pytest.mark.parametrize("seed", range(12))
def test_lists_are_poses_and_repeat(seed):
    one, again = draw_list(seed), draw_list(seed)
    np.testing.assert_array_equal(one.position, again.position)
    assert one.is_path == bool(seed % 2)
    assert (50 <= len(one.position) <= MOST) if one.is_path else (3 <= len(one.position) <= 40)
    np.testing.assert_allclose(np.linalg.det(one.rotation), 1, rtol=1e-9)
    # looks along z: on a column away from each other's backs, in a corner towards each other
    local = [values - values.mean(0) for values in (one.position, -one.rotation[:, :, 2])]
    bulge = np.sum(local[0] * local[1])
    if one.is_path and "flat" not in one.kind:
        assert bulge > 0 if "cylinder" in one.kind else bulge < 1e-2


def test_right_on_held_out_lists_and_the_literal_form_is_not():
    result = run(lists=40, variants=(VARIANTS[0], VARIANTS[-1]))
    right = {row["variant"]: row["ours"] for row in result.table if row["name"] == "right, all"}
    assert set(right) == {"ours", "literal"}
    assert right["ours"] >= 0.95
    assert right["literal"] < 0.8
    assert all(row["published"] is None and row["low"] <= row["ours"] <= row["high"] for row in result.table)
    assert result.figures["statistic"].axes


def test_intervals_are_wilsons():
    np.testing.assert_allclose(wilson(8, 10), (0.4902, 0.9433), atol=1e-4)
    assert wilson(400, 400)[0] == pytest.approx(0.9905, abs=1e-4)
