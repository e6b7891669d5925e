"""The set-up of the whole process: what only the program may decide, and no import."""

import hashlib
import io
import logging
import os
import platform
import signal
import sys
import threading
import time
import warnings
from pathlib import Path

from experiments.interrupts import Interrupted

CACHE_VARIABLE = "JAXPAINT_CACHE"
"""Where compiled programs are kept; an empty value keeps none."""
PROCESSES_HERE = "JAXPAINT_PROCESSES_HERE"
"""How many processes of one run share this machine; set for those that the program starts itself."""
# Programs for one device round differently from those for several: every process has two at least.
_LEAST = 2
# How long a process may take to end once it was told [s].
_LAST = 60.0


def prepare_python() -> None:
    """A termination unwinds like Ctrl-C, libraries warn nobody, and printing works in any encoding."""
    signal.signal(signal.SIGTERM, _interrupt)
    if not sys.warnoptions:
        warnings.simplefilter("ignore")
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")
    os.environ.setdefault("TF_CPP_MIN_LOG_LEVEL", "2")  # read when XLA loads
    if PROCESSES_HERE in os.environ:
        threading.Thread(target=_end_with_the_starter, daemon=True).start()


def prepare_jax() -> None:
    """As many CPU devices as cores, and compiled programs kept between runs; before the first use of jax."""
    import jax

    logging.getLogger("jax").setLevel(logging.ERROR)
    if "xla_force_host_platform_device_count" not in os.environ.get("XLA_FLAGS", ""):
        jax.config.update("jax_num_cpu_devices", max(_LEAST, cores()))
    folder = cache_folder()
    if folder is not None:
        jax.config.update("jax_compilation_cache_dir", str(folder))
        jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.1)


def cores() -> int:
    """Cores this process may use: its affinity, cut by the quota of its control group, and its share where
    one run has several processes here.
    """
    allowed = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    quota = _quota()
    return max(1, (allowed if quota is None else min(allowed, round(quota))) // processes_here())


def processes_here() -> int:
    """Processes of one run that share this machine."""
    return int(os.environ.get(PROCESSES_HERE, "1"))


def cache_folder() -> Path | None:
    """The folder of compiled programs of this kind of processor; None where there is none to be.

    Programs compiled for one processor can stop another with an illegal instruction, and home folders are
    shared between machines: hence a folder for each kind.
    """
    chosen = os.environ.get(CACHE_VARIABLE, os.environ.get("JAX_COMPILATION_CACHE_DIR"))
    if chosen is not None:
        return Path(chosen) if chosen else None
    home = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    folder = Path(home) / "jaxpaint" / f"compiled-{_processor_hash()}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return None
    return folder if os.access(folder, os.W_OK) else None


def _interrupt(number: int, _: object) -> None:
    raise Interrupted(number)


def _end_with_the_starter() -> None:
    """Whoever started this process holds its standard input open, and is gone when that ends."""
    while os.read(0, 1):
        pass
    for patience in (1.0, _LAST):  # the first one may only be noted
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(patience)
    os._exit(128 + signal.SIGTERM)


def _quota() -> float | None:
    try:
        limit, period = Path("/sys/fs/cgroup/cpu.max").read_text().split()
        return None if limit == "max" else int(limit) / int(period)
    except (OSError, ValueError):
        return None


def _processor_hash() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        lines = []
    kind = [line for line in lines if line.startswith(("model name", "flags", "Features", "CPU part"))]
    text = "\n".join([platform.machine(), *sorted(set(kind))])
    return hashlib.sha256(text.encode()).hexdigest()[:12]
