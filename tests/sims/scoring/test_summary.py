"""Figures over worlds under the contract's keys."""

import json
import math
from dataclasses import fields, replace
from typing import Any

import jax.numpy as jnp
import numpy as np
import pytest

from sims.scoring import Chamfer, PaintScore, TrackingScore, WorldScore, summarise, world_scores
from sims.status import Status


def row(value=0.01, status="ok"):
    figures: dict[str, Any] = {field.name: value for field in fields(WorldScore)}
    figures |= {"status": status, "coverage": 1 - value, "halts": 2, "control_steps": 100}
    return WorldScore(**figures)


def test_keys_are_the_contracts():
    assert {
        name: set(part) if isinstance(part, dict) else None for name, part in summarise([row()]).items()
    } == {
        "worlds": None,
        "status": {"ok"},
        "tracking_rmse": {"x", "y", "z", "total", "p95", "max"},
        "normal_error_deg": {"mean", "p95"},
        "paint": {"coverage", "excess", "thickness_cv", "gap_length", "stroke_error"},
        "surface": {"chamfer_l1_raw", "chamfer_l1_refined", "chamfer_l2_raw", "chamfer_l2_refined"},
        "odometry_drift": {"mean", "max"},
        "base_travel": None,
        "halts_per_run": None,
        "duration": None,
        "control_steps": None,
    }
    assert set(summarise([row()])["paint"]["stroke_error"]) == {"mean", "p95", "judged"}


def test_medians_over_worlds():
    found = summarise([row(0.01), row(0.02), row(0.06)])
    assert found["tracking_rmse"]["total"] == pytest.approx(0.02)
    assert found["paint"]["coverage"] == pytest.approx(0.98)
    assert found["halts_per_run"] == 2
    assert found["duration"] == pytest.approx(0.03)
    assert found["control_steps"] == 300


def test_a_failed_world_pushes_the_median_of_errors_up():
    found = summarise([row(0.01), row(0.02), row(0.001, "infeasible")])
    assert found["tracking_rmse"]["total"] == pytest.approx(0.02)
    assert found["paint"]["stroke_error"]["mean"] == pytest.approx(0.02)
    assert found["status"] == {"infeasible": 1, "ok": 2}


def test_when_most_worlds_fail_errors_are_null_and_the_rest_is_json():
    found = summarise([row(0.01), row(math.nan, "diverged"), row(math.nan, "diverged")])
    assert found["tracking_rmse"]["total"] is None
    assert found["paint"]["coverage"] == 0
    assert found["surface"]["chamfer_l1_refined"] is None
    json.dumps(found, allow_nan=False)


def test_what_a_diverged_world_painted_is_no_achievement():
    assert summarise([row(0.0, "diverged")])["paint"]["coverage"] == 0
    assert summarise([row(0.0, "not_converged")])["paint"]["coverage"] == 1


def test_rows_put_the_parts_together():
    names = [field.name for field in fields(TrackingScore)]
    tracking = TrackingScore(**{name: jnp.asarray([0.5, 0.25]) for name in names})
    tracking = replace(tracking, rmse=jnp.asarray([[1.0, 2, 3], [4, 5, 6]]), steps=jnp.asarray([10, 20]))
    paint = [PaintScore(0.9, 0.1, 0.2, 0.3, 0.4, math.nan, 0.8), PaintScore(*[0.5] * 7)]
    raw = Chamfer(l1=jnp.asarray([1.0, 2.0]), l2=jnp.asarray([3.0, 4.0]))
    rows = world_scores(np.asarray([0, 4]), tracking, paint, raw, None, step=0.02)
    assert [r.status for r in rows] == ["ok", "diverged"]
    assert (rows[1].rmse_x, rows[1].rmse_y, rows[1].rmse_z) == (4, 5, 6)
    assert rows[0].normal_error_mean_deg == pytest.approx(math.degrees(0.5))
    assert rows[1].duration == pytest.approx(0.4)
    assert (rows[0].chamfer_l1_raw, rows[1].chamfer_l2_raw) == (1, 4)
    assert rows[0].stroke_error_judged == 0.8
    assert math.isnan(rows[0].chamfer_l1_refined)


def test_every_status_says_what_it_means():
    meanings = {status.label: status.meaning for status in Status}
    assert list(meanings) == ["ok", "unreachable", "infeasible", "not_converged", "diverged"]
    assert len(set(meanings.values())) == 5
