"""The table says what it holds and loses no bit."""

import dataclasses

import numpy as np
import pytest

from experiments.exports import read_table, write_table
from jaxpaint.errors import InputError


def test_reading_gives_the_same_bits(waving, tmp_path):
    write_table(waving, tmp_path / "trajectory.csv")
    found = read_table(tmp_path / "trajectory.csv")
    assert (found.names, found.units) == (waving.names, waving.units)
    for field in ("time", "position", "velocity", "acceleration", "pen"):
        np.testing.assert_array_equal(getattr(found, field), getattr(waving, field))


def test_the_header_has_joints_and_units(waving, tmp_path):
    write_table(waving, tmp_path / "trajectory.csv")
    header = (tmp_path / "trajectory.csv").read_text().splitlines()[0].split(",")
    assert len(header) == len({*header}) == 1 + 3 * 9 + 1
    assert header[0] == "time [s]"
    assert {"base_x position [m]", "elbow velocity [rad/s]", "base_yaw acceleration [rad/s^2]"} <= {*header}


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda lines: ["x,y", "1,2"], "other columns"),
        (lambda lines: lines[:2], "too few rows"),
        (lambda lines: [lines[0], lines[2], lines[1]], "do not increase"),
        (lambda lines: [*lines[:3], "a" + lines[3]], "no table of numbers"),
        (lambda lines: [*lines[:3], "nan" + lines[3][lines[3].index(",") :]], "other columns"),
        (lambda lines: [], "no table of numbers"),
    ],
)
def test_anything_else_is_refused(change, words, waving, tmp_path):
    path = tmp_path / "trajectory.csv"
    write_table(waving, path)
    path.write_text("\n".join(change(path.read_text().splitlines())))
    with pytest.raises(InputError, match=words):
        read_table(path)


def test_a_missing_file_is_refused(tmp_path):
    with pytest.raises(InputError, match="No such file"):
        read_table(tmp_path / "trajectory.csv")


def test_a_plan_is_data(waving):
    with pytest.raises(dataclasses.FrozenInstanceError):
        waving.time = 0
