"""What the painting pipeline hands back, and the keys that the contract asks of it."""

import dataclasses
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from experiments.report.paint import ReportData
    from sims.painting.joint_plan import JointTrajectory

SUMMARY_KEYS: dict[str, tuple[str, ...]] = {
    "worlds": (),
    "status": (),
    "path": ("strokes", "points", "length", "travel"),
    "tracking_rmse": ("x", "y", "z", "total", "p95", "max"),
    "normal_error_deg": ("mean", "p95"),
    "paint": ("coverage", "excess", "thickness_cv", "gap_length", "stroke_error"),
    "surface": ("chamfer_l1_raw", "chamfer_l1_refined", "chamfer_l2_raw", "chamfer_l2_refined"),
    "modes": (),
    "odometry_drift": ("mean", "max"),
    "base_travel": (),
    "halts_per_run": (),
    "duration": (),
    "control_steps": (),
    "steps_per_s": (),
}
"""Keys of the summary, each with those below it; a missing figure is None, a missing key an error."""

TRAJECTORIES: dict[str, str] = {
    "world": "[worlds] index of the world",
    "time": "[worlds, samples] simulated time [s]; rows end in NaN once a world has finished",
    "planned": "[worlds, samples, 3] planned brush position, map frame [m]",
    "pen": "[worlds, samples] whether the plan's pen is down",
    "stroke": "[worlds, samples] number of the drawn stroke, counted from 0; -1 while the pen is up",
    "colour": "[worlds, samples] colour in hand: row of palette",
    "brush": "[worlds, samples, 3] true brush position, map frame [m]",
    "brush_axis": "[worlds, samples, 3] true brush axis into the wall, map frame, unit",
    "normal": "[worlds, samples, 3] true outward normal of the wall at the brush, map frame, unit",
    "base": "[worlds, samples, 3] true base pose x, y [m], yaw [rad], map frame",
    "tilt": "[worlds, samples, 3] true height [m], roll, pitch [rad] of the base over a level floor",
    "odometry": "[worlds, samples, 3] base pose as odometry has it x, y [m], yaw [rad], map frame",
    "joints": "[worlds, samples, arm joints] arm joint positions [rad]",
    "halted": "[worlds, samples] whether the base is halted",
    "mode": "[worlds, samples] controller in charge: 0 trajectory, 1 whole-body",
    "joint_names": "[3 + arm joints] names of the robot's joints: those of base, then those of joints",
    "palette": "[colours, 3] colours of the picture, sRGB from 0 to 1",
}
"""What an array of trajectories.npz may be; `about` in the file repeats the lines of those that are there."""


@dataclasses.dataclass(frozen=True)
class PaintOutcome:
    """All that a painting run gives.

    summary: the contract's keys (`SUMMARY_KEYS`), SI.
    worlds: columns with one entry a world, for runs.parquet; those of `experiments.report.scores.SCORES` are
    shown in the report, `status` is text, others are free.
    trajectories: arrays named in `TRAJECTORIES`, of a few worlds.
    resolved: options left open (None), as they were chosen, by field name of PaintOptions; a repeat takes
    them as given.
    notes: what to tell the user, one sentence each: guesses, what was left out, what was not exported.
    interrupted: a signal broke the run off, and these are the worlds that were finished.
    plan: the planned joint trajectory, where it was asked for. refused: why there is none though it was.
    preview: PNG of the strokes in their order.
    """

    summary: Mapping[str, Any]
    worlds: Mapping[str, np.ndarray]
    trajectories: Mapping[str, np.ndarray]
    report: "ReportData"
    resolved: Mapping[str, Any] = dataclasses.field(default_factory=dict)
    notes: tuple[str, ...] = ()
    interrupted: bool = False
    plan: "JointTrajectory | None" = None
    refused: str = ""
    preview: bytes = b""

    def __post_init__(self) -> None:
        for key, below in SUMMARY_KEYS.items():
            missing = (
                [key]
                if key not in self.summary
                else [f"{key}.{k}" for k in below if k not in self.summary[key]]
            )
            if missing:
                raise ValueError(f"summary: found no {', '.join(missing)}, allowed: all keys of SUMMARY_KEYS")

    @property
    def failure(self) -> str | None:
        """Why nothing was painted, or not exported though it was asked for; None where all went well."""
        status = self.summary["status"]
        if status.get("ok", 0):
            return self.refused or None
        counts = ", ".join(f"{count} {name}" for name, count in status.items() if count)
        return f"no world was painted: {counts}"
