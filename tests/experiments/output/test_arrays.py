"""Arrays that other programs read."""

import numpy as np
import pyarrow.parquet as pq
import pytest

from experiments.output import write_parquet, write_trajectories


def test_one_row_a_world(tmp_path):
    columns = {
        "world": np.arange(3),
        "status": np.array(["ok", "unreachable", "ok"]),
        "tracking_rmse": np.array([1e-3, np.nan, 2e-3], np.float32),
        "base": np.array([[0.0, 1.0], [2.0, np.inf], [4.0, 5.0]]),
        "good": [True, False, True],
    }
    write_parquet(tmp_path / "runs.parquet", columns)
    rows = pq.read_table(tmp_path / "runs.parquet").to_pylist()
    assert list(rows[0]) == list(columns)
    assert rows[1] == {
        "world": 1,
        "status": "unreachable",
        "tracking_rmse": None,
        "base": [2.0, None],
        "good": False,
    }


@pytest.mark.parametrize("columns", [{"a": np.zeros(2), "b": np.zeros(3)}, {"a": np.zeros((2, 2, 2))}])
def test_columns_that_do_not_fit_are_refused(tmp_path, columns):
    with pytest.raises(ValueError, match="columns"):
        write_parquet(tmp_path / "runs.parquet", columns)


def test_trajectories_say_what_they_hold(tmp_path):
    about = {"time": "simulated time [s]", "base": "unused"}
    write_trajectories(tmp_path / "trajectories.npz", {"time": np.arange(4.0)}, about)
    with np.load(tmp_path / "trajectories.npz", allow_pickle=False) as held:
        assert held["about"].tolist() == [["time", "simulated time [s]"]]
        assert held["time"].tolist() == [0, 1, 2, 3]
    with pytest.raises(ValueError, match="speed"):
        write_trajectories(tmp_path / "more.npz", {"speed": np.zeros(1)}, about)


def test_the_same_arrays_give_the_same_bytes(tmp_path):
    for name in ("a", "b"):
        write_trajectories(tmp_path / f"{name}.npz", {"time": np.arange(4.0)}, {"time": "t"})
        write_parquet(tmp_path / f"{name}.parquet", {"time": np.arange(4.0)})
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()
    assert (tmp_path / "a.parquet").read_bytes() == (tmp_path / "b.parquet").read_bytes()
