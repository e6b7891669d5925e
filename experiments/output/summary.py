"""summary.json: what ran, with what, and what came out; no number in it is not finite."""

import dataclasses
import enum
import importlib.metadata
import json
import math
import os
import platform
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from jaxpaint.errors import InputError

PACKAGES = ("jaxpaint", "jax", "mujoco", "mujoco-mjx", "numpy")
LARGEST_SUMMARY = 64 * 2**20


def to_json(value: Any) -> Any:
    """A value as JSON knows it: arrays as lists, enumerations by name, what is not finite as None."""
    if isinstance(value, enum.Enum):
        return value.name
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {field.name: to_json(getattr(value, field.name)) for field in dataclasses.fields(value)}
    if isinstance(value, Mapping):
        return {str(key): to_json(entry) for key, entry in value.items()}
    if isinstance(value, str | bool | int | None):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Path):
        return str(value)
    if isinstance(value, list | tuple):
        return [to_json(entry) for entry in value]
    if hasattr(value, "__array__"):
        return to_json(np.asarray(value).tolist())
    raise TypeError(f"value: found {type(value).__name__}, allowed: what JSON can hold")


def write_json(path: Path, value: Any) -> None:
    """Write JSON with the keys in the order given, whole or not at all."""
    content = json.dumps(to_json(value), indent=2, allow_nan=False) + "\n"
    beside = path.with_name(f".{path.name}.partial")
    beside.write_text(content, encoding="utf-8")
    os.replace(beside, path)


def read_summary(path: Path, command: str) -> dict[str, Any]:
    """The summary of an earlier run of `command`; InputError where the file is something else."""
    allowed = f"the summary.json of an earlier 'jaxpaint {command}'"
    try:
        if path.stat().st_size > LARGEST_SUMMARY:
            raise InputError(f"--config: found {path} (too large), allowed: {allowed}")
        summary = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise InputError(f"--config: found {path} ({_cause(error)}), allowed: {allowed}") from error
    if not isinstance(summary, dict) or not isinstance(summary.get("config"), dict):
        raise InputError(f"--config: found {path} (without a config), allowed: {allowed}")
    if summary.get("command") != command:
        raise InputError(f"--config: found {path} (of {summary.get('command')!r}), allowed: {allowed}")
    return summary


def describe_versions() -> dict[str, str | None]:
    """Versions of what decides the figures; None for what is not installed."""
    return {package: _version(package) for package in PACKAGES} | {"python": platform.python_version()}


def describe_device() -> str:
    """The devices that the work ran on, such as '2 x cpu (AMD EPYC 7B13)'."""
    import jax

    devices = jax.devices()
    kind = devices[0].device_kind
    detail = _processor() if devices[0].platform == "cpu" else devices[0].platform
    return f"{len(devices)} x {kind}" + (f" ({detail})" if detail else "")


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor()
    return next(
        (line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), platform.machine()
    )


def _version(package: str) -> str | None:
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return None


def _cause(error: Exception) -> str:
    return (isinstance(error, OSError) and error.strerror) or "not JSON"
