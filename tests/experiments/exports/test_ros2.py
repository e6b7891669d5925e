"""The message has the fields of trajectory_msgs/msg/JointTrajectory, and both forms of it say the same."""

import dataclasses
import json
import re

import numpy as np
import pytest
import yaml

from experiments.exports import export, to_message

# How YAML 1.1, which ROS reads, knows a number with a fraction; without point or sign it would be text.
YAML_FLOAT = re.compile(r"[-+]?[0-9][0-9_]*\.[0-9_]*([eE][-+][0-9]+)?")


def read_yaml(lines: list[str]):
    """The block style that our writer uses: mappings, lists of mappings, and flow values."""
    return _mapping(lines, 0, 0)[0]


def _mapping(lines, at, indent):
    found = {}
    while at < len(lines) and lines[at].startswith(" " * indent) and lines[at][indent].isalpha():
        key, _, flow = lines[at][indent:].partition(":")
        at += 1
        if flow.strip():
            found[key] = json.loads(flow)
        elif lines[at].startswith(" " * indent + "- "):
            found[key] = []
            while at < len(lines) and lines[at].startswith(" " * indent + "- "):
                lines[at] = lines[at].replace("- ", "  ", 1)
                item, at = _mapping(lines, at, indent + 2)
                found[key].append(item)
        else:
            found[key], at = _mapping(lines, at, indent + 2)
    return found, at


def test_the_message_has_the_fields_of_ros(waving):
    message = to_message(waving)
    assert list(message) == ["header", "joint_names", "points"]
    assert message["header"] == {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": "map"}
    assert message["joint_names"] == list(waving.names)
    assert len(message["points"]) == len(waving.time)
    for point, time in zip(message["points"], waving.time, strict=True):
        assert list(point) == ["positions", "velocities", "accelerations", "effort", "time_from_start"]
        stamp = point["time_from_start"]
        assert isinstance(stamp["sec"], int)
        assert isinstance(stamp["nanosec"], int)
        assert 0 <= stamp["nanosec"] < 10**9
        assert stamp["sec"] + 1e-9 * stamp["nanosec"] == pytest.approx(time, abs=1e-9)
        assert point["effort"] == []
    np.testing.assert_array_equal([point["velocities"] for point in message["points"]], waving.velocity)


def test_json_and_yaml_say_the_same_bit_for_bit(waving, tmp_path):
    written = export(waving, tmp_path, ["ros2-yaml", "ros2-json", "csv", "csv"])
    assert [path.name for path in written] == ["trajectory.yaml", "trajectory.json", "trajectory.csv"]
    assert sorted(tmp_path.iterdir()) == sorted(written)
    message = to_message(waving)
    assert json.loads((tmp_path / "trajectory.json").read_text()) == message
    assert read_yaml((tmp_path / "trajectory.yaml").read_text().splitlines()) == message


def test_a_yaml_parser_reads_it_too(waving, tmp_path):
    for path in export(waving, tmp_path, ["ros2-yaml", "ros2-json"]):
        assert yaml.safe_load(path.read_text()) == to_message(waving)


def test_every_number_is_one_in_yaml_1_1(waving, tmp_path):
    tiny = dataclasses.replace(
        waving, velocity=waving.velocity * 1e-9, acceleration=waving.acceleration * 1e20
    )
    for path in export(tiny, tmp_path, ["ros2-yaml", "ros2-json"]):
        lists = re.findall(r'(?:positions|velocities|accelerations)"?: \[([^]]*)\]', path.read_text())
        words = [word for entry in lists for word in entry.split(", ")]
        assert len(words) == 3 * waving.position.size
        assert any("e" in word for word in words)
        assert [word for word in words if not YAML_FLOAT.fullmatch(word)] == []


def test_names_are_quoted(waving, tmp_path):
    odd = dataclasses.replace(waving, names=("yes", "1", "a: b", "#", '"', *waving.names[5:]))
    (path,) = export(odd, tmp_path, ["ros2-yaml"])
    assert read_yaml(path.read_text().splitlines())["joint_names"] == list(odd.names)


@pytest.mark.parametrize("kind", ["ros2-json", "ros2-yaml"])
def test_a_number_that_is_not_finite_is_refused(kind, waving, tmp_path):
    broken = dataclasses.replace(waving, velocity=waving.velocity + np.nan)
    with pytest.raises(ValueError, match="not finite"):
        export(broken, tmp_path, [kind])
