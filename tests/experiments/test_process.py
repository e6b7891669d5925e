"""The set-up of a process, in processes of its own."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import jax
import jax.numpy as jnp

from experiments import process
from experiments.compile_clock import CompileClock

ROOT = Path(__file__).resolve().parents[2]
# How long a program may take to end where much else runs [s].
SLOW_MACHINE = 300

SLOW_PAINT = """
import sys, time, types
def run(options, progress):
    print("started", flush=True)
    time.sleep(60)
sys.modules["experiments.paint"] = types.SimpleNamespace(run=run)
from experiments.cli import main
sys.argv = ["jaxpaint", "paint", "--out", sys.argv[1]]
sys.exit(main())
"""

PREPARED = """
import jax
from experiments import process
process.prepare_python()
process.prepare_jax()
f = jax.jit(lambda x: jax.numpy.linalg.inv(jax.numpy.sin(x) @ x))
jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.0)
f(jax.numpy.ones((3, 3))).block_until_ready()
print(jax.local_device_count(), process.cores(), jax.config.jax_compilation_cache_dir)
"""


def environment(**more: str) -> dict[str, str]:
    kept = {key: value for key, value in os.environ.items() if not key.startswith(("JAX", "XLA"))}
    return kept | {"PYTHONPATH": str(ROOT), "JAX_PLATFORMS": "cpu"} | more


def test_a_termination_ends_a_run_as_cleanly_as_ctrl_c(tmp_path):
    run = subprocess.Popen(
        [sys.executable, "-c", SLOW_PAINT, str(tmp_path / "out")],
        env=environment(JAXPAINT_CACHE=""), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert run.stdout is not None
    assert run.stdout.readline() == "started\n"
    run.send_signal(signal.SIGTERM)
    _, said = run.communicate(timeout=SLOW_MACHINE)
    assert run.returncode == 128 + signal.SIGTERM
    assert said == "jaxpaint: interrupted; nothing was written\n"
    assert list(tmp_path.iterdir()) == []


def test_a_prepared_process_has_all_cores_and_keeps_compiled_programs(tmp_path):
    found = subprocess.run(
        [sys.executable, "-c", PREPARED],
        env=environment(XDG_CACHE_HOME=str(tmp_path)), capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert found.returncode == 0, found.stderr
    devices, cores, folder = found.stdout.split()
    assert int(devices) == max(2, int(cores)), "fewer would round differently"
    assert Path(folder).is_relative_to(tmp_path / "jaxpaint")
    assert list(Path(folder).iterdir()), "nothing was kept"


def test_the_cache_goes_where_it_is_told(tmp_path, monkeypatch):
    monkeypatch.delenv("JAX_COMPILATION_CACHE_DIR", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "home"))
    monkeypatch.delenv(process.CACHE_VARIABLE, raising=False)
    folder = process.cache_folder()
    assert folder is not None
    assert folder.is_relative_to(tmp_path / "home" / "jaxpaint")
    monkeypatch.setenv(process.CACHE_VARIABLE, str(tmp_path / "mine"))
    assert process.cache_folder() == tmp_path / "mine"
    monkeypatch.setenv(process.CACHE_VARIABLE, "")
    assert process.cache_folder() is None
    monkeypatch.delenv(process.CACHE_VARIABLE)
    (tmp_path / "file").touch()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    assert process.cache_folder() is None


def test_the_clock_counts_compiling_and_nothing_else():
    double = jax.jit(lambda x: 2 * jnp.sin(x) + 1.25)
    with CompileClock() as clock:
        double(jnp.ones(7)).block_until_ready()
    assert clock.seconds > 0
    with CompileClock() as again:
        double(jnp.ones(7)).block_until_ready()
    assert again.seconds == 0


def test_overlapping_spans_count_once():
    clock = CompileClock()
    clock._spans += [(0.0, 4.0), (1.0, 2.0), (3.0, 5.0), (7.0, 8.0)]
    assert clock.seconds == 6.0
