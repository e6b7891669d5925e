"""How many worlds run at once: as many as do any good, and fit into the memory that is allowed."""

import dataclasses
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import NoReturn

import jax

from experiments.commands.paint_options import PaintOptions
from experiments.options import refuse
from experiments.paint_job import PaintTask
from experiments.process import processes_here
from jaxpaint.compiling import CHUNK
from jaxpaint.errors import InputError
from sims.painting.memory_need import MemoryNeed, memory_need, plan_time

# Share of what is free that a run takes unasked: the rest is for the estimate's error and for others.
_SHARE = 0.8
GB = 1e9
# Control groups, of the present and the former kind: folder, limit, what is taken, and of that cached files.
_GROUPS = (
    ("/sys/fs/cgroup/", "memory.max", "memory.current", "inactive_file "),
    ("/sys/fs/cgroup/memory/", "memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file "),
)


@dataclasses.dataclass(frozen=True)
class MemoryPlan:
    """budget: what may be taken, planned: what the run will take at its peak [bytes of host memory]. group:
    how many worlds run at once.
    """

    budget: float
    planned: float
    group: int

    def summary(self) -> dict[str, float | int]:
        """For summary.json."""
        return {"budget_gb": self.budget / GB, "planned_gb": self.planned / GB, "group": self.group}


def memory_plan(task: PaintTask, options: PaintOptions) -> MemoryPlan:
    """The largest group that fits and does any good. Raises InputError where not even the smallest fits."""
    seconds = plan_time(task.job, task.strokes.length, task.strokes.travel)
    devices = jax.local_device_count()
    need = memory_need(
        task.job, task.grid, seconds=seconds, cells=task.wanted.on_surface.size, devices=devices
    )
    used, budget = resident(), budget_of(options)
    worlds = -(-options.worlds // options.processes)
    fits = _fits(need, worlds, budget - used, device_limit() if jax.default_backend() != "cpu" else None)
    step = CHUNK * devices
    most = step if jax.default_backend() == "cpu" else worlds + step
    group = largest_group(fits, worlds, step=step, most=most)
    if group is None:
        _refuse(options, budget, used + need.host(min(step, worlds), worlds))
    return MemoryPlan(budget, used + need.host(group, worlds), group)


def largest_group(fits: Callable[[int], bool], worlds: int, *, step: int, most: int) -> int | None:
    """The largest multiple of `step`, up to `most` and no more than the worlds need, that fits; or all
    worlds, where they are fewer. None where not even the smallest fits.
    """
    sizes = range(step, max(step, min(most, worlds + step - 1)) + 1, step)
    return next((min(size, worlds) for size in reversed(sizes) if fits(min(size, worlds))), None)


def budget_of(options: PaintOptions) -> float:
    """Memory that this process may take [bytes]: its share of --memory-gb, or of most of what is free."""
    if options.memory_gb is not None:
        return options.memory_gb * GB / processes_here()
    return resident() + _SHARE * available() / processes_here()


def available() -> float:
    """Host memory that nobody takes [bytes]: the machine's, and below the limit of the control group."""
    free = _line("/proc/meminfo", "MemAvailable:")
    free = (
        1024 * free if free is not None else float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    )
    return min([free, *(left for left in map(_left, _GROUPS) if left is not None)])


def _left(group: tuple[str, str, str, str]) -> float | None:
    """Below the limit of a control group; files that are only cached give way. None without a limit."""
    folder, limit, taken, cached = group
    most = _number(folder + limit)
    if most is None:
        return None
    files = _line(folder + "memory.stat", cached) or 0.0
    return max(0.0, most - max(0.0, (_number(folder + taken) or 0.0) - files))


def resident() -> float:
    """Host memory that this process takes [bytes]."""
    kilobytes = _line("/proc/self/status", "VmRSS:")
    if kilobytes is not None:
        return 1024 * kilobytes
    import resource

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return float(peak if sys.platform == "darwin" else 1024 * peak)


def device_limit() -> float | None:
    """What the devices of this process have left for a run, all together [bytes]; None where none says."""
    stats = [device.memory_stats() or {} for device in jax.local_devices()]
    free = [s["bytes_limit"] - s.get("bytes_in_use", 0) for s in stats if "bytes_limit" in s]
    return float(len(stats) * min(free)) if len(free) == len(stats) else None


def _fits(need: MemoryNeed, worlds: int, host: float, device: float | None) -> Callable[[int], bool]:
    return lambda group: (
        need.host(group, worlds) <= host and (device is None or need.device(group) <= _SHARE * device)
    )


def _refuse(options: PaintOptions, budget: float, needed: float) -> NoReturn:
    """The one line: what is needed, and what is allowed."""
    needed = needed * processes_here()
    if options.memory_gb is not None:
        refuse("--memory-gb", f"{options.memory_gb:g}", f"at least {needed / GB:.1f} for this run")
    free = budget * processes_here() / GB
    raise InputError(
        f"memory: found {free:.1f} GB to take, allowed: at least {needed / GB:.1f} GB for the smallest group"
        f" of worlds (--memory-gb takes it all the same)"
    )


def _line(path: str, name: str) -> float | None:
    try:
        lines = Path(path).read_text().splitlines()
    except OSError:
        return None
    return next((float(line.split()[1]) for line in lines if line.startswith(name)), None)


def _number(path: str) -> float | None:
    """A limit of the control group; "max", as what cannot be read, is none."""
    try:
        return float(Path(path).read_text())
    except (OSError, ValueError):
        return None
