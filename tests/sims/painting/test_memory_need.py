"""What a run is said to need is what it takes."""

import json
import os
import subprocess
import sys
import tracemalloc
from pathlib import Path

import jax
import numpy as np
import pytest

from sims.painting import run_mission
from sims.painting.memory_need import block_bytes, memory_need, plan_time

ROOT = Path(__file__).resolve().parents[3]
WORLDS = 4
# An estimate may be so much too high, and so much too low.
HIGH, LOW = 1.5, 0.9

# The program as it is started, with the most memory that it took at its end.
PEAK = """
import resource, sys
from experiments.cli import main
status = main()
print(1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
sys.exit(status)
"""


@pytest.fixture(scope="module")
def need(task):
    seconds = plan_time(task.job, task.strokes.length, task.strokes.travel)
    cells = task.wanted.on_surface.size
    return memory_need(task.job, task.grid, seconds=seconds, cells=cells, devices=jax.local_device_count())


def test_how_long_a_plan_takes_is_known_before(task, mission):
    told = plan_time(task.job, task.strokes.length, task.strokes.travel)
    took = float(np.max(mission.painting.path.end))
    assert LOW < told / took < 1 / LOW


def test_what_a_world_of_a_group_takes(task, mission, need):
    """Of a mission whose programs are there: the most of what Python and the devices hold at a time."""
    run_mission(task.job, task.grid, np.arange(WORLDS))  # Tests before may have let go of its programs.
    live = [sum(array.nbytes for array in jax.live_arrays())]

    def look(share=1.0):
        live.append(sum(array.nbytes for array in jax.live_arrays()))

    tracemalloc.start()
    again = run_mission(task.job, task.grid, np.arange(WORLDS), advance=look)
    look()
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert again.status.tolist() == mission.status.tolist()
    took = peak + max(live) - live[0]
    told = WORLDS * (need.each + need.film) + block_bytes(jax.local_device_count(), 4)
    assert LOW < told / took < HIGH, f"{took / 1e6:.2f} MB, told {told / 1e6:.2f} MB"


@pytest.mark.slow
@pytest.mark.parametrize("fidelity", ["kinematic", "dynamic"])
def test_what_a_whole_run_takes(fidelity, two_strokes, tmp_path):
    """Nothing compiled before: what the plan counts with."""
    words = f"--canvas-size 0.5 0.5 --worlds 6 --fidelity {fidelity} --out {tmp_path / 'out'}".split()
    run = subprocess.run(
        [sys.executable, "-c", PEAK, "paint", "--image", str(two_strokes), *words],
        env=os.environ | {"PYTHONPATH": str(ROOT), "JAXPAINT_CACHE": "", "JAX_PLATFORMS": "cpu"},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert run.returncode == 0, run.stderr
    took = int(run.stdout.split()[-1])
    planned = 1e9 * json.loads((tmp_path / "out" / "summary.json").read_text())["memory"]["planned_gb"]
    assert LOW < planned / took < HIGH, f"{took / 1e9:.2f} GB, planned {planned / 1e9:.2f} GB"
