"""The step of `dynamic` as MJX and XLA ship: `mjx.step` under vmap and jit, with default options."""

import time

import jax
import jax.numpy as jnp
import mujoco
import numpy as np

from sims.dynamics.quiet import mjx

_WORLDS, _STEPS = 64, 2


class Shipped:
    """Few worlds and steps: on a CPU they take seconds."""

    def __init__(self, model: mujoco.MjModel, start: np.ndarray, ctrl: np.ndarray) -> None:
        put, data = mjx.put_model(model, impl="jax"), mjx.make_data(model, impl="jax")
        self._inputs = jnp.asarray(start[:_WORLDS], jnp.float32), jnp.asarray(ctrl[:_WORLDS, 0], jnp.float32)

        def roll(q, ctrl):
            first = data.replace(qpos=q, ctrl=ctrl)
            return jax.lax.scan(lambda d, _: (mjx.step(put, d), None), first, None, length=_STEPS)[0].qpos

        begin = time.perf_counter()
        self._run = jax.jit(jax.vmap(roll)).lower(*self._inputs).compile()
        self.compile_s = time.perf_counter() - begin

    def rate(self) -> float:
        """Physics steps a second."""
        begin = time.perf_counter()
        jax.block_until_ready(self._run(*self._inputs))
        return _WORLDS * _STEPS / (time.perf_counter() - begin)
