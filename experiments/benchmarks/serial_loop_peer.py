"""Peer of the control step: MuJoCo in C, one world, a Jacobian, a QP by DAQP and `mj_step` in a Python loop.

It is what a user would write today. Needs the extra `bench`.
"""

import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Self

import daqp
import mujoco
import numpy as np
from jaxtyping import Float

_JOINTS, _TASK_ROWS = 9, 6
_MODEL = Path(__file__).with_name("planar_arm.xml")
_READY = (0.0, 0.0, 0.0, 0.0, -1.2, 1.8, -0.6, 1.57, 0.0)  # elbow up, the brush in front: far from singular
_SPEED, _TURN = 0.05, 0.01  # [m/s], [rad a step]: the brush draws a circle
_BOUND = 1.0  # [rad/s, m/s]


class SerialLoop:
    """One robot and what its controller needs; `step` advances it by one control step of 20 ms."""

    def __init__(self) -> None:
        self.model = mujoco.MjModel.from_xml_path(str(_MODEL))
        self.data = mujoco.MjData(self.model)
        self.data.qpos[:] = _READY
        mujoco.mj_forward(self.model, self.data)
        self.site = self.model.site("brush").id
        self.jacobian = np.zeros((_TASK_ROWS, _JOINTS))
        self._hessian, self._linear = 0.01 * np.eye(_JOINTS), np.zeros(_JOINTS)
        # 0 is an inequality, the box; 5 an equality (active 1, and never dropped 4), the task.
        self._sense = np.array([0] * _JOINTS + [5] * _TASK_ROWS, dtype=np.int32)

    def step(self, twist: Float[np.ndarray, "6"]) -> None:
        """Moves the brush with `twist` (linear [m/s], angular [rad/s], world) at the least joint speed."""
        mujoco.mj_jacSite(self.model, self.data, self.jacobian[:3], self.jacobian[3:], self.site)
        above = np.r_[np.full(_JOINTS, _BOUND), twist]
        below = np.r_[np.full(_JOINTS, -_BOUND), twist]
        self.data.ctrl[:] = daqp.solve(self._hessian, self._linear, self.jacobian, above, below, self._sense)[
            0
        ]
        mujoco.mj_step(self.model, self.data)


def circle_twist(step: int) -> Float[np.ndarray, "6"]:
    """The demand of control step `step`: a circle in the floor's plane, no turning."""
    angle = step * _TURN
    return np.array([_SPEED * np.sin(angle), _SPEED * np.cos(angle), 0.0, 0.0, 0.0, 0.0])


def control_steps_per_second(steps: int = 5000) -> float:
    """The rate of the whole loop [1/s]."""
    loop = SerialLoop()
    start = time.perf_counter()
    for step in range(steps):
        loop.step(circle_twist(step))
    return steps / (time.perf_counter() - start)


class SerialLoops:
    """The loop in several processes at once, which wait for work from `with` to its end."""

    def __init__(self, processes: int) -> None:
        self._count = processes
        self._pool = ProcessPoolExecutor(processes, mp_context=get_context("spawn"))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self._pool.shutdown()

    def rate(self, steps: int = 5000) -> float:
        """The rate of all of them together [1/s]."""
        return sum(self._pool.map(control_steps_per_second, [steps] * self._count))
