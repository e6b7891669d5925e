"""The last section of every report: what ran, with what."""

from collections.abc import Mapping
from typing import Any

from experiments.report.page import Section
from experiments.tables import Table, in_words


def settings(summary: Mapping[str, Any]) -> Section:
    """Options, versions, device and times from a run's summary."""
    options = tuple((name.replace("_", "-"), _words(value)) for name, value in summary["config"].items())
    versions = tuple((name, version) for name, version in summary["versions"].items())
    run = (
        ("device", summary["device"]),
        ("compiling [s]", in_words(summary["compile_s"])),
        ("running [s]", in_words(summary["run_s"])),
    )
    tables = (
        Table(("option", "value"), options, "Options"),
        Table(("package", "version"), versions, "Versions"),
        Table(("", ""), run, "Run"),
    )
    return Section(
        "Settings", "summary.json beside this page holds the same; --config repeats the run.", (), tables
    )


def _words(value: Any) -> str:
    if isinstance(value, list | tuple):
        return " ".join(_words(entry) for entry in value)
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.6g}" if isinstance(value, float) else in_words(value)
