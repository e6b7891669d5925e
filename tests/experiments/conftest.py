"""Painting runs made up for the tests: the shapes and keys of real ones, no physics."""

from pathlib import Path

import mujoco
import numpy as np
import pytest

from experiments.commands.paint_options import PaintOptions
from experiments.commands.paint_outcome import SUMMARY_KEYS, TRAJECTORIES, PaintOutcome
from experiments.options import to_config
from experiments.output import write_json, write_trajectories
from experiments.report import PaintedWall, SurfacePath, TrackingError
from experiments.report.paint import ReportData
from sims.robots import robot_model

WORLDS = 24


@pytest.fixture(scope="session")
def made_up() -> PaintOutcome:
    """24 worlds of which one is unreachable; two wavy strokes on a cylinder of radius 2 m."""
    return PaintOutcome(
        summary=_summary(),
        worlds=_worlds(),
        trajectories={"time": np.linspace(0, 9, 10)[None], "planned": np.zeros((1, 10, 3))},
        report=_report(),
        resolved={"canvas_size": [2.4, 0.8], "theta": 0.4},
        notes=("Up is taken to be -y.",),
    )


def _summary() -> dict:
    return {
        "worlds": WORLDS,
        "status": {"ok": WORLDS - 1, "unreachable": 1},
        "path": {"strokes": 2, "points": 800, "length": 4.9, "travel": 0.6},
        "tracking_rmse": {"x": 2e-3, "y": 3e-3, "z": 1e-3, "total": 3.7e-3, "p95": 7e-3, "max": 0.011},
        "normal_error_deg": {"mean": 0.8, "p95": 2.1},
        "paint": {
            "coverage": 0.981,
            "excess": 0.012,
            "thickness_cv": 0.1,
            "gap_length": None,
            "stroke_error": {"mean": 2.4e-3, "p95": 6e-3},
        },
        "surface": dict.fromkeys(SUMMARY_KEYS["surface"]),
        "modes": {"trajectory": 0.2, "whole-body": 0.8},
        "odometry_drift": {"mean": 0.011, "max": 0.03},
        "base_travel": 1.9,
        "halts_per_run": 6.0,
        "duration": 187.0,
        "control_steps": 18700,
        "steps_per_s": 350_000.0,
    }


def _worlds() -> dict[str, np.ndarray]:
    random = np.random.default_rng(0)
    columns = {
        "tracking_rmse": random.gamma(9, 4e-4, WORLDS),
        "normal_error_deg": random.gamma(9, 0.09, WORLDS),
        "coverage": 1 - random.gamma(4, 0.005, WORLDS),
        "excess": random.gamma(3, 0.004, WORLDS),
        "stroke_error": random.gamma(9, 3e-4, WORLDS),
        "odometry_drift": random.gamma(3, 4e-3, WORLDS),
    }
    for column in columns.values():
        column[5] = np.nan
    index = np.arange(WORLDS)
    return {"world": index, "status": np.where(index == 5, "unreachable", "ok"), **columns}


def _report() -> ReportData:
    u = np.linspace(-1.2, 1.2, 300)
    strokes = [np.column_stack([u, 0.2 * np.sin(6 * u + turn) + turn / 8]) for turn in (0, 2)]
    uv = np.concatenate([strokes[0], np.linspace(strokes[0][-1], strokes[1][-1], 40), strokes[1][::-1]])
    pen = np.repeat([True, False, True], [300, 40, 300])
    wanted = _inked(strokes, 0.0)
    median = _wall(_inked(strokes, 0.004), "median world, 3")
    worst = _wall(_inked(strokes, 0.02) & _grid_mask(), "worst world, 17")
    return ReportData(
        wanted,
        (median, worst),
        _path(uv, pen),
        _tracking(pen),
        dropped={"off the surface": 3, "too steep": 0},
    )


def _grid() -> tuple[np.ndarray, np.ndarray]:
    return np.meshgrid(np.arange(-1.5, 1.5, 0.01) + 0.005, np.arange(-0.8, 0.8, 0.01) + 0.005)


def _grid_mask() -> np.ndarray:
    u, _ = _grid()
    return np.abs(u - 0.4) > 0.1


def _inked(strokes: list[np.ndarray], shift: float) -> np.ndarray:
    u, v = _grid()
    near = np.zeros(u.shape, bool)
    for stroke in strokes:
        near |= np.abs(np.interp(u, *stroke.T) + shift - v) < 0.02
    return near & (np.abs(u) < 1.2)


def _wall(painted: np.ndarray, name: str) -> PaintedWall:
    u, _ = _grid()
    return PaintedWall(painted * (1 + 0.3 * np.sin(9 * u)) * 1e-4, painted, (-1.5, -0.8), (1.5, 0.8), name)


def _path(uv: np.ndarray, pen: np.ndarray) -> SurfacePath:
    grid = np.stack(np.meshgrid(np.linspace(-1.6, 1.6, 60), np.linspace(-0.9, 0.9, 30)), -1)
    base = np.column_stack([np.full(50, -0.9), np.linspace(0.9, -0.9, 50)])
    return SurfacePath(_on_cylinder(uv), _normal(uv), pen, _on_cylinder(grid), base)


def _on_cylinder(uv: np.ndarray) -> np.ndarray:
    angle = uv[..., 0] / 2
    return np.stack([2 * np.cos(angle) - 2, -2 * np.sin(angle), uv[..., 1] + 1.2], -1)


def _normal(uv: np.ndarray) -> np.ndarray:
    angle = uv[..., 0] / 2
    return np.stack([-np.cos(angle), np.sin(angle), np.zeros_like(angle)], -1)


def _tracking(pen: np.ndarray) -> TrackingError:
    time = np.linspace(0, 187, len(pen))
    median = 2e-3 + 1.5e-3 * np.abs(np.sin(time / 6)) + np.where(pen, 0, 5e-3)
    return TrackingError(time, median / 2, median, median * 2, pen, (np.sin(time / 6) > 0).astype(float))


@pytest.fixture(scope="session")
def recorded_run(tmp_path_factory) -> Path:
    """The folder of a made-up run: the reference robot goes along the flat wall, its arm at rest, and draws
    two strokes in two colours, though in the air. Worlds 3 and 1 are recorded; world 1 did not move.
    """
    folder = tmp_path_factory.mktemp("recorded")
    model = robot_model()
    data = mujoco.MjData(model)
    time = np.arange(60) * 0.08
    base = np.column_stack([np.full(60, -0.9), 0.4 - 0.15 * time, np.zeros(60)])
    arm = np.tile(model.key_qpos[0, -6:], (60, 1))
    brush = np.zeros((60, 3))
    for k in range(60):
        data.qpos[:3], data.qpos[-6:] = base[k], arm[k]
        mujoco.mj_kinematics(model, data)
        brush[k] = data.site("brush").xpos
    names = [model.joint(k).name for k in (0, 1, 2, *range(model.njnt - 6, model.njnt))]
    stroke = np.repeat([0, -1, 1], 20)
    motion = {"brush": brush, "base": base, "tilt": np.zeros((60, 3)), "joints": arm}
    arrays = {
        "world": np.array([3, 1]),
        "time": np.stack([time, np.full(60, np.nan)]),
        **{name: np.stack([x, x]) for name, x in motion.items()},
        "stroke": np.stack([stroke, stroke]),
        "colour": np.stack([stroke == 1] * 2).astype(np.int8),
        "palette": np.array([[0.1, 0.2, 0.6], [0.8, 0.1, 0.1]]),
        "joint_names": np.array(names),
    }
    write_trajectories(folder / "trajectories.npz", arrays, TRAJECTORIES)
    write_json(
        folder / "summary.json", {"command": "paint", "config": to_config(PaintOptions()), "worlds": 4}
    )
    return folder
