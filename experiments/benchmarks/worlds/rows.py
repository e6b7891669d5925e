"""Worlds: steps a second of every fidelity beside MuJoCo in C and a serial loop, and against their number."""

import jax
import numpy as np

from experiments.benchmarks.compare import compare
from experiments.benchmarks.rows import Bench, BenchRow
from experiments.benchmarks.serial_loop_peer import control_steps_per_second
from experiments.benchmarks.worlds.painting_steps import PaintingSteps
from experiments.benchmarks.worlds.physics_rollouts import DynamicRollout, PhysicsRollout, WheeledRollout
from experiments.benchmarks.worlds.scaling import (
    WORLDS,
    Point,
    scaling,
    scaling_figure,
    scaling_summary,
    scaling_table,
)
from experiments.benchmarks.worlds.shipped import Shipped

_C, _LOOP = "mujoco.rollout, all cores", "MuJoCo and DAQP in a loop"
_STEPS, _CHUNK_DYNAMIC, _CHUNK_WHEELED = 50, 128, 32
_WORLDS, _PAINTING = 512, 1024
# Ours in float32 may be so far from C's in float64 after the steps of a call [m, rad].
_CLOSE = {"dynamic": 1e-4, "wheeled": 1e-3}


def measured() -> Bench:
    """All rows, then every fidelity against the number of worlds. Nothing is taken from a cache of compiled
    programs, since the time to compile is told.
    """
    before = jax.config.jax_enable_compilation_cache  # type: ignore[attr-defined]
    jax.config.update("jax_enable_compilation_cache", False)
    try:
        return _measured()
    finally:
        jax.config.update("jax_enable_compilation_cache", before)


def _measured() -> Bench:
    dynamic = DynamicRollout(_WORLDS, _STEPS, _CHUNK_DYNAMIC)
    wheeled = WheeledRollout(_WORLDS, _STEPS, _CHUNK_WHEELED)
    for name, physics in (("dynamic", dynamic), ("wheeled", wheeled)):
        _check(name, physics)
    shipped = Shipped(dynamic.model, dynamic.start, dynamic.ctrl)
    painting, clear = PaintingSteps(_PAINTING, clearance=False), PaintingSteps(_PAINTING)
    rows = [
        compare("dynamic-rollout", dynamic.rate, dynamic.c_rate, _C),
        compare("dynamic-rollout-shipped", dynamic.rate, shipped.rate, "mjx.step as XLA ships", rounds=3),
        compare("wheeled-rollout", wheeled.rate, wheeled.c_rate, _C),
        compare("painting-step", painting.rate, control_steps_per_second, _LOOP),
        compare("painting-step-clear", clear.rate, control_steps_per_second, _LOOP),
        compare("painting-gradient", painting.gradient_rate, painting.rate, "the same without gradient"),
    ]
    most = max(WORLDS)
    points = [
        *scaling("dynamic", DynamicRollout(most, _STEPS, _CHUNK_DYNAMIC)),
        *scaling("wheeled", WheeledRollout(most, _STEPS, _CHUNK_WHEELED)),
        *scaling("kinematic painting", PaintingSteps(most, clearance=False)),
    ]
    rows += _linear(points)
    peers = {"dynamic": rows[0].peer, "wheeled": rows[2].peer, "kinematic painting": rows[3].peer}
    return Bench(
        rows,
        tables=(scaling_table(points),),
        figures={"worlds": scaling_figure(points, peers)},
        summary={"scaling": scaling_summary(points), "shipped_compile_s": shipped.compile_s},
    )


def _check(name: str, physics: PhysicsRollout) -> None:
    """Both simulate the same, or no rate means anything."""
    off = np.abs(np.asarray(physics.positions(), float) - physics.c_positions())
    if not np.median(off.max(axis=1)) < _CLOSE[name]:
        raise RuntimeError(f"{name}: {np.median(off.max(axis=1)):.2g} off MuJoCo's positions")


def _linear(points: list[Point]) -> list[BenchRow]:
    """The most worlds beside the best number of them, and 4,096 beside 512."""
    rows = []
    for name in dict.fromkeys(p.fidelity for p in points):
        mine = {p.worlds: p.rate for p in points if p.fidelity == name}
        best = max(mine, key=lambda worlds: mine[worlds])
        short = name.replace(" ", "-")
        rows.append(BenchRow(f"{short}-8192-worlds", mine[8192], mine[best], f"the same, {best} worlds"))
        rows.append(BenchRow(f"{short}-4096-worlds", mine[4096], mine[512], "the same, 512 worlds"))
    return rows
