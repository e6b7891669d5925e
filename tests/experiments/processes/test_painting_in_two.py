"""The whole program in two processes: the same figures as in one."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
# What depends on the machine's speed and on how the work was split.
OF_THE_RUN = ("compile_s", "run_s", "steps_per_s", "memory", "processes", "device", "files")

PICTURE = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 60 60" fill="none" stroke="black">
<path d="M5 10 H40"/><path d="M5 30 Q25 50 50 30"/></svg>"""


@pytest.mark.slow
def test_two_processes_find_what_one_finds(tmp_path):
    (tmp_path / "two.svg").write_text(PICTURE)
    found = [painted(tmp_path, processes) for processes in (1, 2)]
    one, two = ((folder / "runs.parquet").read_bytes() for folder in found)
    assert one == two
    first, second = (json.loads((folder / "summary.json").read_text()) for folder in found)
    assert (first["processes"], second["processes"]) == (1, 2)
    for name in set(first) - set(OF_THE_RUN):
        assert first[name] == second[name], name
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["cache", "out-1", "out-2", "two.svg"]


def painted(folder: Path, processes: int) -> Path:
    """The result folder of five worlds."""
    out = folder / f"out-{processes}"
    where = f"--image {folder / 'two.svg'} --canvas-size 0.5 0.5 --out {out}"
    words = ["paint", *where.split(), "--worlds", "5", "--processes", str(processes)]
    own = {"PYTHONPATH": str(ROOT), "JAX_PLATFORMS": "cpu", "JAXPAINT_CACHE": str(folder / "cache")}
    run = subprocess.run(
        [sys.executable, "-c", "from experiments.cli import main; raise SystemExit(main())", *words],
        env=os.environ | own, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert run.returncode == 0, run.stderr
    assert run.stderr == ""
    return out
