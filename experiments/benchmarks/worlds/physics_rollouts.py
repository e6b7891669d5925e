"""Physics alone, many worlds at once, beside `mujoco.rollout` on the same model from the same states."""

import abc
import copy
from typing import Any

import jax
import jax.numpy as jnp
import mujoco
import mujoco.rollout
import numpy as np
from jaxtyping import Array, Float

from experiments.benchmarks.compare import rate
from experiments.process import cores
from jaxpaint.compiling import batched, on_devices
from sims.dynamics import Engine, physics_of, planar_model
from sims.robots import load_robot, robot_model
from sims.wheeled import Motion, WheeledEngine, at_rest, wheeled_model, wheeled_physics
from sims.wheeled.in_c import in_c

_STEP = 0.005
# More worlds run in groups of as many, one program for all, as a painting run does.
GROUP = 512


class PhysicsRollout(abc.ABC):
    """Robots that hold their arms and drive: `worlds` of them, so many physics steps a call.

    chunk: worlds that a device takes at a time. Ours in float32, MuJoCo's in float64.
    """

    physics: Any
    engine: Any

    def __init__(self, worlds: int, steps: int, chunk: int) -> None:
        self.worlds, self.steps = worlds, steps
        self.model = self._model()
        self.start, self.ctrl = self._told(np.random.default_rng(0))
        self.program = batched(self._roll, in_axes=(None, 0, 0), chunk=chunk)
        self._single = np.asarray(self.start, np.float32), np.asarray(self.ctrl, np.float32)
        self._threads = [mujoco.MjData(self.model) for _ in range(cores())]

    @abc.abstractmethod
    def _model(self) -> mujoco.MjModel:
        """What both simulate."""

    @abc.abstractmethod
    def _told(self, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
        """Positions at the start [worlds, nq], and controls [worlds, steps, nu]."""

    @abc.abstractmethod
    def _roll(self, physics, q: Float[Array, " nq"], ctrl: Float[Array, "t nu"]) -> Float[Array, " nq"]:
        """One world's positions at the end."""

    def positions(self) -> Float[np.ndarray, "worlds nq"]:
        """Ours, at the end."""
        parts = groups(self._single, self.worlds)
        return np.concatenate([self.program(self.physics, *part) for part in parts])

    def rate(self, worlds: int | None = None) -> float:
        """Physics steps a second, of the first so many worlds."""
        count = worlds or self.worlds
        parts = [on_devices_if_whole(part) for part in groups(self._single, count)]

        def work():
            for part in parts:
                jax.block_until_ready(self.program(self.physics, *part))

        return rate(work, count * self.steps)

    def c_positions(self) -> Float[np.ndarray, "worlds nq"]:
        """MuJoCo's, at the end, on all cores."""
        first = np.zeros((self.worlds, 1 + self.model.nq + self.model.nv))
        first[:, 1 : 1 + self.model.nq] = self.start
        states, _ = mujoco.rollout.rollout(self.model, self._threads, first, self.ctrl)
        return states[:, -1, 1 : 1 + self.model.nq]

    def c_rate(self) -> float:
        """The same a second."""
        return rate(self.c_positions, self.worlds * self.steps)


def groups(inputs: tuple, worlds: int) -> list[tuple]:
    """The first so many worlds, a group at a time."""
    return [tuple(x[k : min(k + GROUP, worlds)] for x in inputs) for k in range(0, worlds, GROUP)]


def on_devices_if_whole(part: tuple) -> tuple:
    """Placed once, so that no call moves them, where the group is a whole one."""
    return on_devices(part) if len(part[0]) == GROUP else part


class DynamicRollout(PhysicsRollout):
    """The planar model of fidelity `dynamic`: implicitfast, no contacts."""

    def _model(self) -> mujoco.MjModel:
        planar = planar_model(robot_model())
        self.physics, self.engine = physics_of(planar), Engine(planar)
        model = copy.deepcopy(planar)
        model.opt.timestep = _STEP
        model.actuator_biasprm[3:, 1] = -np.asarray(self.physics.position_gain)
        return model

    def _told(self, rng):
        home = np.asarray(load_robot().home, float)
        start = np.zeros((self.worlds, self.model.nq))
        start[:, 3:] = home + rng.normal(0, 0.1, (self.worlds, len(home)))
        ctrl = np.zeros((self.worlds, self.steps, self.model.nu))
        ctrl[..., :3] = rng.normal(0, 200, (self.worlds, 1, 3))
        ctrl[..., 3:] = np.asarray(self.physics.position_gain) * home
        return start, ctrl

    def _roll(self, physics, q, ctrl):
        model, none = self.engine.with_physics(physics, jnp.asarray(_STEP, q.dtype)), jnp.zeros((), q.dtype)

        def step(state, row):
            return self.engine.advance(model, *state, row, none), None

        return jax.lax.scan(step, (q, jnp.zeros_like(q)), ctrl)[0][0]


class WheeledRollout(PhysicsRollout):
    """The model of fidelity `wheeled`: contacts of four wheels, and as many iterations for both."""

    def _model(self) -> mujoco.MjModel:
        home = np.asarray(load_robot().home, float)
        sunk = at_rest(wheeled_model(robot_model()), home)
        rolling = wheeled_model(robot_model(), height=-float(sunk.tilt[0]))
        self.physics, self.engine = wheeled_physics(rolling), WheeledEngine(rolling)
        model, ours = in_c(rolling, self.physics, _STEP), rolling.opt
        model.opt.iterations, model.opt.ls_iterations = ours.iterations, ours.ls_iterations
        return model

    def _told(self, rng):
        """Wheels turn by angles of their own, and roll."""
        home, kp = np.asarray(load_robot().home, float), np.asarray(self.physics.position_gain, float)
        start = np.zeros((self.worlds, self.model.nq))
        start[:, 3], start[:, -len(home) :] = 1.0, home
        data = mujoco.MjData(self.model)
        data.qpos[:] = start[0]
        mujoco.mj_forward(self.model, data)
        time = np.arange(self.steps) * _STEP
        ctrl = np.zeros((self.worlds, self.steps, self.model.nu))
        angle = rng.uniform(-0.5, 0.5, (self.worlds, 1, 1)) * np.clip(time / 0.3, 0, 1)[:, None]
        spin = rng.uniform(-3, 3, (self.worlds, 1, 1)) * np.clip(time / 0.5, 0, 1)[:, None]
        ctrl[..., 0:8:2] = kp[0:8:2] * angle
        ctrl[..., 1:8:2] = kp[1:8:2] * np.cumsum(spin, axis=1) * _STEP
        ctrl[..., 8:] = kp[8:] * home + data.qfrc_bias[14:]
        return start, ctrl

    def _roll(self, physics, q, ctrl):
        model = self.engine.with_physics(physics, jnp.asarray(_STEP, q.dtype))
        still = jnp.zeros(self.model.nv, q.dtype)
        none = jnp.zeros(self.model.nu, q.dtype)

        def step(state, row):
            return self.engine.advance(model, state, row, none), None

        return jax.lax.scan(step, Motion(q, still, still), ctrl)[0].q
