"""`jaxpaint paint`: the main job, from options to files."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from experiments.commands.command import Command, Outcome
from experiments.commands.paint_options import PaintOptions
from experiments.commands.paint_outcome import TRAJECTORIES, PaintOutcome
from experiments.output import RunFolder, write_parquet, write_trajectories
from experiments.progress import progress
from experiments.tables import Table, in_words, quantity


def execute(options: PaintOptions, folder: RunFolder) -> Outcome:
    """Run the pipeline and write runs.parquet, trajectories.npz, strokes.png and what is exported."""
    from experiments.exports import export
    from experiments.paint import run
    from experiments.report.paint import build_page

    found = run(options, progress)
    write_parquet(folder.path("runs.parquet"), found.worlds)
    write_trajectories(folder.path("trajectories.npz"), found.trajectories, TRAJECTORIES)
    if found.preview:
        folder.path("strokes.png").write_bytes(found.preview)
    written = [] if found.plan is None else export(found.plan, folder.path(""), options.export)
    return Outcome(
        summary={
            **found.summary,
            "notes": list(found.notes),
            "exported": [path.name for path in written],
        },
        tables=(result_table(options, found),),
        report=lambda summary: build_page(found.report, summary, found.worlds, found.notes),
        resolved=found.resolved,
        failure=found.failure,
        interrupted=found.interrupted,
    )


def result_table(options: PaintOptions, found: PaintOutcome) -> Table:
    """The result in a dozen lines, in units that a person reads."""
    s: Mapping[str, Any] = found.summary
    status = ", ".join(f"{count} {name}" for name, count in s["status"].items() if count)
    modes = ", ".join(f"{name} {quantity(share, 100, '%')}" for name, share in s["modes"].items())
    rows = (
        ("status", f"{status} of {s['worlds']} worlds"),
        ("path", f"{quantity(s['path']['length'], 1, 'm')} in {s['path']['strokes']} strokes"),
        ("tracking RMSE", _with_tail(s["tracking_rmse"], "total", 1e3, "mm")),
        ("brush normal error", _with_tail(s["normal_error_deg"], "mean", 1, "°")),
        ("coverage", quantity(s["paint"]["coverage"], 100, "%")),
        ("excess", quantity(s["paint"]["excess"], 100, "%")),
        ("stroke error", _with_tail(s["paint"]["stroke_error"] or {}, "mean", 1e3, "mm")),
        ("base travel", quantity(s["base_travel"], 1, "m")),
        ("halts a run", in_words(s["halts_per_run"])),
        ("decisions", modes or in_words(None)),
        ("simulated time", quantity(s["duration"], 1, "s")),
        ("control steps", quantity(s["steps_per_s"], 1, "per s")),
        *(("note", note) for note in found.notes),
    )
    picture = options.image.name if options.image else "built-in drawing"
    title = f"{picture} on {Path(options.wall).name}, {options.fidelity}, {options.controller}"
    return Table(("score", "value"), rows, title)


def _with_tail(score: Mapping[str, Any], key: str, factor: float, unit: str) -> str:
    """A score with the 95th percentile beside it."""
    return f"{quantity(score.get(key), factor, unit)} (95 %: {quantity(score.get('p95'), factor, unit)})"


def share(options: PaintOptions) -> None:
    """The work of a further process."""
    from experiments.paint import run_share

    run_share(options)


COMMAND = Command("paint", PaintOptions, execute, share)
