"""A run repeated from its summary is the same, bit for bit."""

import json

import numpy as np
import pytest

from experiments.cli import main

PICTURE = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 60 60" fill="none" stroke="black">
<path d="M5 10 H40"/><path d="M5 30 Q25 50 50 30"/></svg>"""
# What the clock says, and nothing else, differs from run to run.
CLOCKED = ("compile_s", "run_s", "steps_per_s")


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """A short run, and its repetition."""
    folder = tmp_path_factory.mktemp("runs")
    (folder / "two.svg").write_text(PICTURE)
    first = f"--image {folder}/two.svg --canvas-size 0.5 0.5 --worlds 4 --seed 11 --out {folder}/a"
    again = f"--config {folder}/a/summary.json --out {folder}/b"
    assert main(["paint", *first.split()]) == 0
    assert main(["paint", *again.split()]) == 0
    return folder


def test_every_key_but_the_clock_is_the_same(runs):
    first, second = (json.loads((runs / name / "summary.json").read_text()) for name in "ab")
    assert list(first) == list(second)
    for key in first:
        if key not in CLOCKED:
            assert first[key] == second[key], key
    assert first["seed"] == 11


def test_every_array_is_the_same(runs):
    assert (runs / "a" / "runs.parquet").read_bytes() == (runs / "b" / "runs.parquet").read_bytes()
    with np.load(runs / "a" / "trajectories.npz") as a, np.load(runs / "b" / "trajectories.npz") as b:
        assert set(a) == set(b)
        for name in a:
            np.testing.assert_array_equal(a[name], b[name], err_msg=name)


def test_compared_with_itself_nothing_differs(runs):
    assert main(["compare", str(runs / "a"), str(runs / "b"), "--out", str(runs / "c")]) == 0
    found = json.loads((runs / "c" / "summary.json").read_text())
    assert found["paired"] is True
    assert found["options"] == []
    named = {row["name"]: row for row in found["rows"] if row["name"] not in CLOCKED}
    assert {row["difference"] for row in named.values()} <= {0, None}
    rmse = named["tracking_rmse.total"]
    assert (rmse["low"], rmse["high"]) == (0, 0)
