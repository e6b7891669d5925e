"""A joint trajectory as a ROS 2 message `trajectory_msgs/msg/JointTrajectory`, in JSON and in YAML."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from sims.painting.joint_plan import JointTrajectory

FRAME = "map"
_NANO = 10**9


def to_message(plan: "JointTrajectory") -> dict[str, Any]:
    """The message's fields by name, nested as the message is; the stamp zero means 'start at once'."""
    stamps = [divmod(round(time * _NANO), _NANO) for time in plan.time.tolist()]
    figures = zip(
        plan.position.tolist(), plan.velocity.tolist(), plan.acceleration.tolist(), stamps, strict=True
    )
    return {
        "header": {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": FRAME},
        "joint_names": list(plan.names),
        "points": [
            {
                "positions": position,
                "velocities": velocity,
                "accelerations": acceleration,
                "effort": [],
                "time_from_start": {"sec": sec, "nanosec": nanosec},
            }
            for position, velocity, acceleration, (sec, nanosec) in figures
        ],
    }


def write_json(plan: "JointTrajectory", path: Path) -> None:
    """The message as JSON, one point a line."""
    _check(plan)
    message = to_message(plan)
    points = ",\n".join(f"  {_flow(point)}" for point in message["points"])
    head = ",\n".join(f" {_flow(key)}: {_flow(message[key])}" for key in ("header", "joint_names"))
    path.write_text(f'{{\n{head},\n "points": [\n{points}\n ]\n}}\n', encoding="utf-8")


def write_yaml(plan: "JointTrajectory", path: Path) -> None:
    """The message as YAML, as `ros2 topic pub` reads it."""
    _check(plan)
    path.write_text("\n".join(_block(to_message(plan))) + "\n", encoding="utf-8")


def _check(plan: "JointTrajectory") -> None:
    figures = (plan.time, plan.position, plan.velocity, plan.acceleration)
    if not all(np.isfinite(x).all() for x in figures):
        raise ValueError("plan: found a number that is not finite, allowed: finite numbers")


def _block(value: dict[str, Any], indent: str = "") -> Iterator[str]:
    """A mapping in block style; lists of mappings one below the other, all other lists in one line."""
    for key, entry in value.items():
        if isinstance(entry, dict):
            yield f"{indent}{key}:"
            yield from _block(entry, indent + "  ")
        elif entry and isinstance(entry, list) and isinstance(entry[0], dict):
            yield f"{indent}{key}:"
            for item in entry:
                first, *rest = _block(item, indent + "  ")
                yield f"{indent}- {first.lstrip()}"
                yield from rest
        else:
            yield f"{indent}{key}: {_flow(entry)}"


def _flow(value: Any) -> str:
    """A value in one line that is JSON and YAML alike."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(key)}: {_flow(entry)}" for key, entry in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(_flow(entry) for entry in value) + "]"
    return _digits(value) if isinstance(value, float) else json.dumps(value)


def _digits(number: float) -> str:
    """All digits. YAML 1.1, which ROS reads, takes 1e-05 for text and 1.0e-05 for a number."""
    text = repr(number)
    return text if "." in text else text.replace("e", ".0e")
