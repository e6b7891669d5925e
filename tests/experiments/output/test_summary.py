"""summary.json holds what JSON can hold."""

import enum
import json
import math
from pathlib import Path

import jax.numpy as jnp
import numpy as np
import pytest

from experiments.output import describe_device, describe_versions, read_summary, write_json
from jaxpaint.errors import InputError


class Colour(enum.IntEnum):
    RED = 0


def test_what_is_not_finite_is_null_and_keys_keep_their_order(tmp_path):
    value = {
        "z": math.nan,
        "a": [np.float32(0.5), np.inf, jnp.ones(2)],
        "array": np.array([[1.0, np.nan]]),
        "whole": np.int64(3),
        "flag": np.bool_(True),
        "path": Path("wall.pcd"),
        "colour": Colour.RED,
        3: (1, None),
    }
    write_json(tmp_path / "summary.json", value)
    read = json.loads((tmp_path / "summary.json").read_text(), parse_constant=pytest.fail)
    assert list(read) == ["z", "a", "array", "whole", "flag", "path", "colour", "3"]
    assert list(read.values()) == [
        None,
        [0.5, None, [1.0, 1.0]],
        [[1.0, None]],
        3,
        True,
        "wall.pcd",
        "RED",
        [1, None],
    ]
    assert [entry.name for entry in tmp_path.iterdir()] == ["summary.json"]


def test_what_json_cannot_hold_is_refused_and_nothing_written(tmp_path):
    with pytest.raises(TypeError, match="object"):
        write_json(tmp_path / "summary.json", {"a": object()})
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "text", ["", "[]", "words", '{"command": "paint"}', '{"command": "paint", "config": 3}', "[" * 100_000]
)
def test_a_config_that_is_none_is_named(tmp_path, text):
    (tmp_path / "summary.json").write_text(text)
    with pytest.raises(InputError, match=r"--config: found .*summary\.json"):
        read_summary(tmp_path / "summary.json", "paint")


def test_versions_and_device_are_told():
    versions = describe_versions()
    assert versions["numpy"] == np.__version__
    assert versions["jax"] is not None
    assert " x " in describe_device()
