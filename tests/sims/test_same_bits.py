"""A world's bits depend neither on the chunk it is computed in, nor on the number of devices and worlds."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]

# Short rollouts of a few worlds that start and slip differently: for each chunk, all that came out.
ROLLOUTS = """
import sys
import jax, jax.numpy as jnp, numpy as np
from jaxpaint.compiling import batched
from jaxpaint.decisions import default_thresholds
from jaxpaint.kinematics import forward
from opt.plan import Samples
from opt.trajectory import TrajectoryController
from opt.wbc import WholeBodyController, default_settings
from sims.limits import robot_limits
from sims.noise import noise_preset
from sims.odometry import Slip
from sims.robots import load_robot, robot_model
from sims.rollout import run_block, start
from sims.worlds import Kinematic, standing
kind, out, worlds, *chunks = sys.argv[1:]
robot, noise = load_robot(), noise_preset("s1-simulation").odometry
limits, dt = robot_limits(robot), jnp.asarray(0.02)
if kind == "dynamic":
    from sims.dynamics import dynamic
    fidelity = dynamic(robot_model())
else:
    fidelity = Kinematic()
def follow(limits, base, arm):
    brush = forward(limits.chain, jnp.concatenate([base, arm]))
    row = jnp.concatenate([brush.p, brush.R.reshape(-1), jnp.asarray([0, 0.03, 0, 0, 0, 0, 1.0])])
    rows = jnp.tile(row, (30, 1)).at[:, 1].add(0.0006 * jnp.arange(30))
    zero, far = 0 * dt, base + jnp.asarray([0.0, 0.3, 0.0])
    if kind == "dynamic":
        still = jnp.concatenate([base, arm, jnp.zeros(3), jnp.full(6, 0.2), jnp.ones(1)])
        plan = Samples(jnp.tile(still, (30, 1)), dt, zero)
        return TrajectoryController(limits.chain, plan, zero + 1.0, zero + 10)
    speed = zero + 0.03
    plan = Samples(rows, dt, zero), Samples(far[None], dt, zero)
    return WholeBodyController(
        limits, default_settings(), default_thresholds(), *plan, speed, zero + 1, zero + 10
    )
def one(limits, noise, fidelity, dt, number):
    key = jax.random.fold_in(jax.random.key(0), number)
    off = 0.01 * jax.random.normal(key, (9,))
    base, arm = off[:3], robot.home + off[3:]
    world = standing(base, arm, Slip(off[:4], 0.1 * off[4:8]), 4)
    controller = follow(limits, base, arm)
    state = start(controller, fidelity, world)
    return run_block(controller, fidelity, limits, noise, dt, state, key, records=5)
index, found = np.arange(int(worlds)), {}
for chunk in chunks:
    run = batched(one, in_axes=(None, None, None, None, 0), chunk=int(chunk))
    leaves = jax.tree.leaves(run(limits, noise, fidelity, dt, index))
    found |= {f"{chunk}-{k}": np.asarray(leaf) for k, leaf in enumerate(leaves)}
np.savez(out, devices=jax.local_device_count(), **found)
"""


def rollouts(
    kind: str, devices: int, worlds: int, chunks: list[int], out: Path
) -> dict[int, list[np.ndarray]]:
    """The leaves of what came out, by chunk."""
    kept = {key: value for key, value in os.environ.items() if not key.startswith(("JAX", "XLA"))}
    flag = f"--xla_force_host_platform_device_count={devices}"
    words = [kind, str(out), str(worlds), *map(str, chunks)]
    subprocess.run(
        [sys.executable, "-c", ROLLOUTS, *words],
        env=kept | {"PYTHONPATH": str(ROOT), "JAX_PLATFORMS": "cpu", "XLA_FLAGS": flag},
        check=True,
    )
    with np.load(out) as held:
        assert held["devices"] == devices
        count = sum(name.startswith(f"{chunks[0]}-") for name in held.files)
        return {chunk: [held[f"{chunk}-{k}"] for k in range(count)] for chunk in chunks}


def differing(one: list[np.ndarray], other: list[np.ndarray]) -> dict[int, float]:
    """The leaves whose bits differ in the worlds that both have, and by how much at most."""
    pairs = [(a[: len(b)], b[: len(a)]) for a, b in zip(one, other, strict=True)]
    return {k: float(np.abs(a - b).max()) for k, (a, b) in enumerate(pairs) if not np.array_equal(a, b)}


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["kinematic", "dynamic"])
def test_neither_chunk_nor_devices_nor_worlds_change_a_bit(kind, tmp_path):
    some = rollouts(kind, 2, 20, [16, 32], tmp_path / "two.npz")
    others = rollouts(kind, 3, 5, [16, 32], tmp_path / "three.npz")
    spread = [np.ptp(leaf, axis=0).max() for leaf in some[16] if leaf.dtype == np.float32]
    assert max(spread) > 1e-3, "worlds differ"
    for found in (*some.values(), *others.values()):
        assert differing(some[16], found) == {}


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["kinematic", "dynamic"])
def test_one_device_is_the_same_but_for_rounding(kind, tmp_path):
    """Its programs are not partitioned. The program gives every process two."""
    alone = rollouts(kind, 1, 20, [16, 32], tmp_path / "one.npz")
    beside = rollouts(kind, 2, 5, [16], tmp_path / "two.npz")
    assert differing(alone[16], alone[32]) == {}
    assert max(differing(alone[16], beside[16]).values(), default=0.0) < 1e-6
